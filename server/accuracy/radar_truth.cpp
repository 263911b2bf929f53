#include "server/accuracy/radar_truth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Sharp azimuths that are integrated at a time.
constexpr int kStretch = 64;
/// Facets are sorted by the logarithm of the cosine of their elevation, in steps of so much; one between two
/// steps is shared by both, so that its mean cosine stays: g^2 is off by the square of it.
constexpr double kLayer = 0.01;
/// Below this a beam of any use is as wide as all azimuths.
constexpr double kSteepest = 1e-4;

/// What of an azimuth bin of the truth is seen at about one elevation, after the pulse.
struct Layer {
  double cos_elevation = 1;
  std::vector<double> ground_w, building_w;  // [n_range]; empty: nothing
};
using Row = std::vector<Layer>;

class RadarTruth {
 public:
  RadarTruth(const FramePlan& plan, const AzimuthRuns& runs, const ReferenceSampling& sampling)
      : plan_(plan),
        s_(plan.settings()),
        sampling_(sampling),
        pattern_(s_),
        response_(s_),
        view_(reference_view(plan)) {
    sampling_.planes_per_bin = std::max(1, (sampling.planes_per_bin + kTruthParts - 1) / kTruthParts);
    bin_rad_ = view_.sector_rad / s_.azimuth_bins;
    spacing_m_ = (s_.r_max_m - s_.r_min_m) / s_.range_bins;
    widen();
    respond();
    truth_.runs = runs;
    truth_.n_range = s_.range_bins;
    const std::size_t size =
        static_cast<std::size_t>(azimuth_count(runs)) * static_cast<std::size_t>(s_.range_bins);
    truth_.ground_w.assign(size, 0);
    truth_.building_w.assign(size, 0);
    truth_.buildings.resize(plan.scene().world().buildings.list.size());
    for (const AzimuthRange& run : runs)
      for (int k = 0; k < run.count; ++k) outputs_.push_back((run.first + k + 0.5) * bin_rad_);
  }

  TruthBins integrate(const Progress& progress) {
    for (int first = 0; first < view_.azimuth_bins; first += kStretch) {
      const int count = std::min(kStretch, view_.azimuth_bins - first);
      if (wanted(first, count)) add(first, count);
      if (progress) progress("truth", static_cast<double>(first + count) / view_.azimuth_bins);
    }
    if (s_.range_normalisation) normalise();
    return std::move(truth_);
  }

 private:
  void widen() {
    const int extent = s_.pulse.kind == PulseKind::off ? 0 : s_.pulse.extent_bins;
    const int near = std::min(extent, static_cast<int>(s_.r_min_m / spacing_m_));
    const double nearest_m = std::max(0.0, s_.r_min_m - near * spacing_m_);
    const double reach_rad = s_.beam.pattern == BeamPattern::off ? 0 : beam_reach_rad(nearest_m);
    const double width_rad = std::min(2 * kPi, view_.sector_rad + 2 * reach_rad);
    view_.azimuth_bins = static_cast<int>(std::ceil(width_rad / bin_rad_ * kTruthParts - 1e-9));
    start_rad_ = (view_.sector_rad - width_rad) / 2;  // of the first sharp azimuth, from the sector's start
    view_.sector_rad = width_rad;
    reach_rad_ = reach_rad;
    first_range_ = near * kTruthParts;
    last_offset_ = extent * kTruthParts + kTruthParts / 2;
    view_.range_bins = (s_.range_bins + near + extent) * kTruthParts;
    view_.r_min_m = nearest_m;
    view_.r_max_m = s_.r_max_m + extent * spacing_m_;
    view_.range_normalisation = false;
    view_.keeps_facets = true;
  }

  /// How far off the boresight a beam may see the lowest ground from the nearest range: where
  /// cos(e) sin(azimuth) is the sine of its extent.
  double beam_reach_rad(double nearest_m) const {
    double lowest_m = view_.antenna_m.y;
    for (const float y_m : plan_.scene().world().grid.y_m)
      if (!std::isnan(y_m)) lowest_m = std::min(lowest_m, static_cast<double>(y_m));
    const double drop_m = view_.antenna_m.y - lowest_m;
    if (drop_m >= nearest_m || pattern_.extent_rad() >= kPi / 2) return kPi;
    const double cosine = std::sqrt(1 - drop_m * drop_m / (nearest_m * nearest_m));
    const double sine = std::sin(pattern_.extent_rad()) / cosine;
    return sine >= 1 ? kPi : std::min(kPi, std::asin(sine) + (turns() ? bin_rad_ : 0));
  }

  bool turns() const { return s_.scan_mode != ScanMode::frame; }

  double middle_rad(int azimuth) const {
    return start_rad_ + (azimuth + 0.5) * view_.sector_rad / view_.azimuth_bins;
  }

  /// From one bearing to another the short way round.
  static double between_rad(double from, double to) { return std::remainder(to - from, 2 * kPi); }

  bool wanted(int first, int count) const {
    const double from = middle_rad(first) - bin_rad_;
    const double half = (middle_rad(first + count - 1) + bin_rad_ - from) / 2;
    return std::ranges::any_of(outputs_, [&](double output) {
      return std::abs(between_rad(output, from + half)) <= half + reach_rad_ + bin_rad_;
    });
  }

  void add(int first, int count) {
    const ReferenceBins bins =
        integrate_reference(plan_.scene().world(), plan_.scene().materials(), view_, sampling_, first, count);
    for (std::size_t b = 0; b < bins.buildings.size(); ++b) truth_.buildings[b].add(bins.buildings[b]);
    std::vector<Row> rows(static_cast<std::size_t>(count));
    for_each_row(count, [&](int k) { rows[static_cast<std::size_t>(k)] = row_of(bins, k); });
    for_each_row(static_cast<int>(outputs_.size()), [&](int output) {
      for (int k = 0; k < count; ++k) add(rows[static_cast<std::size_t>(k)], middle_rad(first + k), output);
    });
  }

  /// The pulse's sum over ranges, of each layer.
  Row row_of(const ReferenceBins& bins, int azimuth) const {
    std::map<int, Layer> sharp;
    for (const FacetEcho& facet : bins.facets[static_cast<std::size_t>(azimuth)]) {
      const double cosine = std::sqrt(std::max(0.0, 1 - facet.sin_elevation * facet.sin_elevation));
      const double place = -std::log(std::max(kSteepest, cosine)) / kLayer;
      const int number = static_cast<int>(place);
      const double lower = facet.power_w * (number + 1 - place);
      add_sharp(facet, lower, sharp[number]);
      add_sharp(facet, facet.power_w - lower, sharp[number + 1]);
    }
    Row row;
    for (const auto& [number, layer] : sharp)
      row.push_back({std::exp(-number * kLayer), after_pulse(layer.ground_w), after_pulse(layer.building_w)});
    return row;
  }

  void add_sharp(const FacetEcho& facet, double power_w, Layer& layer) const {
    std::vector<double>& of = facet.of_building ? layer.building_w : layer.ground_w;
    if (of.empty()) of.resize(static_cast<std::size_t>(view_.range_bins));
    of[static_cast<std::size_t>(facet.range_bin)] += power_w;
  }

  std::vector<double> after_pulse(const std::vector<double>& sharp_w) const {
    std::vector<double> gates(static_cast<std::size_t>(s_.range_bins));
    for (std::size_t j = 0; j < sharp_w.size(); ++j) {
      if (sharp_w[j] == 0) continue;
      // For a gate sharp bins count from last_offset_ before its middle to as many behind it.
      const int from_first = static_cast<int>(j) - first_range_ - kTruthParts / 2;
      const int m0 = std::max(0, below(from_first - last_offset_) + 1);
      const int m1 = std::min(s_.range_bins - 1, below(from_first + last_offset_));
      const double power_w = sharp_w[j] * eclipsed(static_cast<double>(j));
      for (int m = m0; m <= m1; ++m)
        gates[static_cast<std::size_t>(m)] +=
            response2_[static_cast<std::size_t>(from_first - m * kTruthParts + last_offset_)] * power_w;
    }
    return gates;
  }

  /// Whole gates in so many sharp bins, rounded down.
  static int below(int sharp_bins) {
    return sharp_bins >= 0 ? sharp_bins / kTruthParts : -((kTruthParts - 1 - sharp_bins) / kTruthParts);
  }

  /// What eclipsing leaves of the power of a sharp bin.
  double eclipsed(double sharp_bin) const {
    if (s_.pulse.kind == PulseKind::off || !s_.pulse.eclipse) return 1;
    const double range_m = view_.r_min_m + (sharp_bin + 0.5) * spacing_m_ / kTruthParts;
    const double share = std::min(1.0, range_m / response_.half_pulse_m());
    return share * share;
  }

  /// p^2 of sharp bins by their place before and behind a gate's middle.
  void respond() {
    for (int k = -last_offset_; k < last_offset_; ++k) {
      const double p =
          s_.pulse.kind == PulseKind::off ? 1 : response_.at((k + 0.5) * spacing_m_ / kTruthParts);
      response2_.push_back(p * p);
    }
  }

  /// The two-way pattern at an azimuth off the boresight, seen from that elevation; of a turning antenna the
  /// mean over the bin, by Simpson's rule.
  double gain(double offset_rad, double cos_elevation) const {
    const auto at = [&](double azimuth) {
      const double u = std::asin(cos_elevation * std::sin(azimuth));
      return pattern_.power_gain(std::abs(azimuth) <= kPi / 2 ? u : std::copysign(kPi, azimuth) - u);
    };
    if (!turns()) return at(offset_rad);
    return (at(offset_rad - bin_rad_ / 2) + 4 * at(offset_rad) + at(offset_rad + bin_rad_ / 2)) / 6;
  }

  void add(const Row& row, double azimuth_rad, int output) {
    const double offset = between_rad(outputs_[static_cast<std::size_t>(output)], azimuth_rad);
    const bool sharp = s_.beam.pattern == BeamPattern::off;
    if (sharp ? std::abs(offset) > bin_rad_ / 2 : std::abs(offset) > reach_rad_) return;
    const std::size_t start = static_cast<std::size_t>(output) * static_cast<std::size_t>(s_.range_bins);
    for (const Layer& layer : row) {
      const double g = sharp ? 1 : gain(offset, layer.cos_elevation);
      if (g == 0) continue;
      for (std::size_t m = 0; m < layer.ground_w.size(); ++m) {
        truth_.ground_w[start + m] += g * g * layer.ground_w[m];
        truth_.building_w[start + m] += g * g * layer.building_w[m];
      }
    }
  }

  void normalise() {
    for (std::size_t k = 0; k < truth_.ground_w.size(); ++k) {
      const auto gate = static_cast<double>(k % static_cast<std::size_t>(s_.range_bins));
      const double range_m = s_.r_min_m + (gate + 0.5) * spacing_m_;
      const double r4 = range_m * range_m * range_m * range_m;
      truth_.ground_w[k] *= r4;
      truth_.building_w[k] *= r4;
    }
  }

  const FramePlan& plan_;
  const RadarSettings& s_;
  ReferenceSampling sampling_;
  AzimuthPattern pattern_;
  PointResponse response_;
  ReferenceView view_;  // of the sharp truth
  double bin_rad_ = 0;
  double spacing_m_ = 0;
  double start_rad_ = 0;
  double reach_rad_ = 0;
  int first_range_ = 0;
  int last_offset_ = 0;
  std::vector<double> response2_;  // [2 last_offset_]
  std::vector<double> outputs_;    // middles, from the sector's start
  TruthBins truth_;
};

}  // namespace

TruthBins integrate_radar_truth(const FramePlan& plan, const AzimuthRuns& runs,
                                const ReferenceSampling& sampling, const Progress& progress) {
  return RadarTruth(plan, runs, sampling).integrate(progress);
}

}  // namespace obliq
