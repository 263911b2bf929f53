#include "server/accuracy/truth_bins.h"

#include <algorithm>
#include <functional>

#include "server/radar/echo/antenna_pattern.h"

namespace obliq {

AzimuthRuns choose_azimuths(int azimuth_bins, int wanted) {
  if (wanted <= 0 || wanted >= azimuth_bins) return {{0, azimuth_bins}};
  const int wedges = (azimuth_bins + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins;
  const int chosen = std::min(wedges, (wanted + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  AzimuthRuns runs;
  for (int k = 0; k < chosen; ++k) {
    const int first = static_cast<int>((k + 0.5) * wedges / chosen) * kWedgeAzimuthBins;
    runs.push_back({first, std::min(kWedgeAzimuthBins, azimuth_bins - first)});
  }
  return runs;
}

int azimuth_count(const AzimuthRuns& runs) {
  int count = 0;
  for (const AzimuthRange& run : runs) count += run.count;
  return count;
}

std::vector<double> TruthBins::power_w(Returns returns) const {
  if (returns == Returns::terrain) return ground_w;
  if (returns == Returns::buildings) return building_w;
  std::vector<double> sum = ground_w;
  std::transform(sum.begin(), sum.end(), building_w.begin(), sum.begin(), std::plus<>());
  return sum;
}

bool TruthBins::lit() const {
  const auto has_power = [](double w) { return w > 0; };
  return std::ranges::any_of(ground_w, has_power) || std::ranges::any_of(building_w, has_power);
}

void TruthBins::append(const ReferenceBins& bins) {
  runs.push_back({bins.first_azimuth, bins.n_azimuth});
  n_range = bins.n_range;
  ground_w.insert(ground_w.end(), bins.ground_w.begin(), bins.ground_w.end());
  building_w.insert(building_w.end(), bins.building_w.begin(), bins.building_w.end());
  buildings.resize(bins.buildings.size());
  for (std::size_t i = 0; i < buildings.size(); ++i) {
    buildings[i].visible_sr += bins.buildings[i].visible_sr;
    buildings[i].unoccluded_sr += bins.buildings[i].unoccluded_sr;
    buildings[i].largest_share = std::max(buildings[i].largest_share, bins.buildings[i].largest_share);
  }
}

ReferenceView reference_view(const FramePlan& plan) {
  const RadarSettings& settings = plan.settings();
  ReferenceView view;
  view.antenna_m = plan.sector().antenna_m;
  view.bearing_rad = plan.sector().bearing_rad;
  view.sector_rad = plan.sector().width_rad;
  view.azimuth_bins = settings.azimuth_bins;
  view.r_min_m = settings.r_min_m;
  view.r_max_m = settings.r_max_m;
  view.range_bins = settings.range_bins;
  view.wavelength_m = plan.wavelength_m();
  view.power_w = settings.power_w;
  view.gain = AntennaPattern(settings.gain_db).power_gain(0, 0);
  view.range_normalisation = settings.range_normalisation;
  return view;
}

RangeBins range_bins(const RadarSettings& settings) {
  return {settings.r_min_m, (settings.r_max_m - settings.r_min_m) / settings.range_bins, settings.range_bins,
          settings.range_normalisation};
}

TruthBins integrate_truth(const FramePlan& plan, const AzimuthRuns& runs, const ReferenceSampling& sampling,
                          const Progress& progress) {
  TruthBins truth;
  const ReferenceView view = reference_view(plan);
  const double all = azimuth_count(runs);
  for (const AzimuthRange& run : runs) {
    const double before = azimuth_count(truth.runs);
    const Progress part = [&](std::string_view stage, double fraction) {
      if (progress) progress(stage, (before + fraction * run.count) / all);
    };
    truth.append(integrate_reference(plan.scene().world(), plan.scene().materials(), view, sampling,
                                     run.first, run.count, part));
  }
  return truth;
}

std::vector<double> power_of_runs(const BinBlock& block, const AzimuthRuns& runs) {
  std::vector<double> power_w;
  power_w.reserve(static_cast<std::size_t>(azimuth_count(runs)) * static_cast<std::size_t>(block.n_range));
  for (const AzimuthRange& run : runs) {
    const auto first = static_cast<std::ptrdiff_t>(run.first - block.first_azimuth) * block.n_range;
    const auto end = first + static_cast<std::ptrdiff_t>(run.count) * block.n_range;
    power_w.insert(power_w.end(), block.power_w.begin() + first, block.power_w.begin() + end);
  }
  return power_w;
}

}  // namespace obliq
