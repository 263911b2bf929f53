#include "server/accuracy/truth_bins.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include "server/radar/beam/patterns.h"
#include "server/radar/echo/sea_clutter.h"
#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

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
  for (std::size_t i = 0; i < buildings.size(); ++i) buildings[i].add(bins.buildings[i]);
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
  view.wavelength_m = plan.looks_at().wavelength_m();
  view.power_w = settings.power_w;
  view.gain = std::pow(10.0, settings.gain_db / 10);
  view.range_normalisation = settings.range_normalisation;
  const AtmosphereSettings& air = settings.atmosphere;
  view.sea = {sea_state(settings), settings.frequency_ghz, air.polarisation == Polarisation::vertical,
              air.wind_m_s > 0, air.wind_from_deg * kDegree_rad + plan.pose().north_rad};
  view.vertical = settings.atmosphere.polarisation == Polarisation::vertical;
  if (settings.beam.elevation == ElevationPattern::off) return view;
  // About the antenna's own vertical.
  const ElevationTable& table = plan.looks_at().antenna_gain().elevation();
  view.two_way_gain = [pattern = ElevationGain(settings, plan.looks_at().antenna_gain().tilt_rad()),
                       rise = plan.looks_at().antenna_gain().rise(), lean_x = table.lean_x,
                       lean_z = table.lean_z](double sine, double bearing_rad) {
    const double level = std::sqrt(std::max(0.0, 1 - sine * sine));
    const double own = sine + level * (lean_x * std::sin(bearing_rad) + lean_z * std::cos(bearing_rad));
    const double gain = pattern.power_gain(std::asin(std::clamp(rise * own, -1.0, 1.0)));
    return gain * gain;
  };
  return view;
}

RangeBins range_bins(const RadarSettings& settings) {
  return {settings.r_min_m, settings.range_bin_m(), settings.range_bins, settings.range_normalisation};
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

namespace {

constexpr std::uint64_t kMagic = 0x3230485552545142;  // "BQTRUH02", read back on the same machine only

/// A building that has anything to say.
struct BuildingRecord {
  std::uint32_t index;
  std::uint32_t zero = 0;
  BuildingTruth truth;
};

struct RecordHead {
  std::int32_t first_azimuth;
  std::int32_t n_azimuth;
  std::int32_t n_range;
  std::int32_t n_buildings;  ///< records that follow the planes
};

/// Bytes of one record, its hash behind them.
std::string record_of(const ReferenceBins& bins) {
  std::vector<BuildingRecord> seen;
  for (std::uint32_t i = 0; i < bins.buildings.size(); ++i)
    if (bins.buildings[i].unoccluded_sr > 0 || bins.buildings[i].visible_sr > 0)
      seen.push_back({i, 0, bins.buildings[i]});
  const RecordHead head{bins.first_azimuth, bins.n_azimuth, bins.n_range,
                        static_cast<std::int32_t>(seen.size())};
  std::string bytes;
  const auto put = [&](const void* from, std::size_t n) { bytes.append(static_cast<const char*>(from), n); };
  put(&head, sizeof head);
  put(bins.ground_w.data(), bins.ground_w.size() * sizeof(double));
  put(bins.building_w.data(), bins.building_w.size() * sizeof(double));
  put(seen.data(), seen.size() * sizeof(BuildingRecord));
  return bytes;
}

/// The next record if it is the one that is wanted, whole and undamaged.
std::optional<ReferenceBins> read_record(std::ifstream& file, const AzimuthRange& wanted, int n_range,
                                         std::size_t n_buildings) {
  RecordHead head{};
  std::string bytes(sizeof head, '\0');
  if (!file.read(bytes.data(), sizeof head)) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.first_azimuth != wanted.first || head.n_azimuth != wanted.count || head.n_range != n_range ||
      head.n_buildings < 0 || static_cast<std::size_t>(head.n_buildings) > n_buildings)
    return std::nullopt;
  const std::size_t plane = static_cast<std::size_t>(head.n_azimuth) * static_cast<std::size_t>(n_range);
  const std::size_t rest =
      2 * plane * sizeof(double) + static_cast<std::size_t>(head.n_buildings) * sizeof(BuildingRecord);
  bytes.resize(sizeof head + rest);
  std::uint64_t hash = 0;
  if (!file.read(bytes.data() + sizeof head, static_cast<std::streamsize>(rest)) ||
      !file.read(reinterpret_cast<char*>(&hash), sizeof hash) || hash != checksum(bytes.data(), bytes.size()))
    return std::nullopt;

  ReferenceBins bins{head.first_azimuth, head.n_azimuth, n_range, {}, {}, {}, {}};
  const char* from = bytes.data() + sizeof head;
  const auto take = [&](void* to, std::size_t n) {
    std::memcpy(to, from, n);
    from += n;
  };
  bins.ground_w.resize(plane);
  bins.building_w.resize(plane);
  bins.buildings.resize(n_buildings);
  take(bins.ground_w.data(), plane * sizeof(double));
  take(bins.building_w.data(), plane * sizeof(double));
  for (std::int32_t k = 0; k < head.n_buildings; ++k) {
    BuildingRecord record{};
    take(&record, sizeof record);
    if (record.index >= n_buildings) return std::nullopt;
    bins.buildings[record.index] = record.truth;
  }
  return bins;
}

/// Each run in stretches of one wedge.
AzimuthRuns stretches_of(const AzimuthRuns& runs) {
  AzimuthRuns stretches;
  for (const AzimuthRange& run : runs)
    for (int at = run.first; at < run.first + run.count; at += kWedgeAzimuthBins)
      stretches.push_back({at, std::min(kWedgeAzimuthBins, run.first + run.count - at)});
  return stretches;
}

}  // namespace

TruthBins integrate_truth_in_file(const std::filesystem::path& path, std::uint64_t key, const FramePlan& plan,
                                  const AzimuthRuns& runs, const ReferenceSampling& sampling,
                                  const Progress& progress) {
  const AzimuthRuns stretches = stretches_of(runs);
  const World& world = plan.scene().world();
  const std::uint64_t head[2] = {kMagic, key};
  TruthBins truth;
  std::uintmax_t good = 0;  // bytes of the file that are worth keeping
  if (std::ifstream file(path, std::ios::binary); file) {
    std::uint64_t found[2] = {0, 0};
    file.read(reinterpret_cast<char*>(found), sizeof found);
    if (file && found[0] == head[0] && found[1] == head[1]) good = sizeof head;
    while (good > 0 && truth.runs.size() < stretches.size()) {
      const auto bins =
          read_record(file, stretches[truth.runs.size()], plan.bins().n_range, world.buildings.list.size());
      if (!bins) break;
      truth.append(*bins);
      good = static_cast<std::uintmax_t>(file.tellg());
    }
  }
  const auto refuse = [&] { throw InputError(path.string() + ": cannot be written (disk full?)"); };
  if (good > 0) std::filesystem::resize_file(path, good);
  std::ofstream file(path, std::ios::binary | (good > 0 ? std::ios::app : std::ios::trunc));
  if (good == 0) file.write(reinterpret_cast<const char*>(head), sizeof head);

  for (std::size_t k = truth.runs.size(); k < stretches.size(); ++k) {
    const ReferenceBins bins = integrate_reference(world, plan.scene().materials(), reference_view(plan),
                                                   sampling, stretches[k].first, stretches[k].count);
    truth.append(bins);
    const std::string bytes = record_of(bins);
    const std::uint64_t hash = checksum(bytes.data(), bytes.size());
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.write(reinterpret_cast<const char*>(&hash), sizeof hash);
    file.flush();
    if (!file) refuse();
    if (progress) progress("truth", static_cast<double>(k + 1) / static_cast<double>(stretches.size()));
  }
  if (!file) refuse();
  truth.runs = runs;  // joined again
  return truth;
}

}  // namespace obliq
