#include "server/accuracy/radar_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
/// Sharp azimuths that are integrated at a time.
constexpr int kStretch = 64;
/// A beam seen from steeper than this is as wide as all azimuths: what the beam's own plan assumes.
constexpr double kLeastCosine = 0.5;

/// One azimuth bin of the truth, after the pulse.
struct Row {
  std::vector<double> ground_w, building_w, cos_elevation;  // [n_range]
};

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
    const double reach_rad =
        s_.beam.pattern == BeamPattern::off
            ? 0
            : std::min(kPi, (pattern_.extent_rad() + (turns() ? bin_rad_ : 0)) / kLeastCosine);
    const double width_rad = std::min(2 * kPi, view_.sector_rad + 2 * reach_rad);
    view_.azimuth_bins = static_cast<int>(std::ceil(width_rad / bin_rad_ * kTruthParts - 1e-9));
    start_rad_ = (view_.sector_rad - width_rad) / 2;  // of the first sharp azimuth, from the sector's start
    view_.sector_rad = width_rad;
    reach_rad_ = reach_rad;
    const int extent = s_.pulse.kind == PulseKind::off ? 0 : s_.pulse.extent_bins;
    const int near = std::min(extent, static_cast<int>(s_.r_min_m / spacing_m_));
    first_range_ = near * kTruthParts;
    last_offset_ = extent * kTruthParts + kTruthParts / 2;
    view_.range_bins = (s_.range_bins + near + extent) * kTruthParts;
    view_.r_min_m = std::max(0.0, s_.r_min_m - near * spacing_m_);
    view_.r_max_m = s_.r_max_m + extent * spacing_m_;
    view_.range_normalisation = false;
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
    for (std::size_t b = 0; b < bins.buildings.size(); ++b) {
      truth_.buildings[b].visible_sr += bins.buildings[b].visible_sr;
      truth_.buildings[b].unoccluded_sr += bins.buildings[b].unoccluded_sr;
      truth_.buildings[b].largest_share =
          std::max(truth_.buildings[b].largest_share, bins.buildings[b].largest_share);
    }
    std::vector<Row> rows(static_cast<std::size_t>(count));
    for_each_row(count, [&](int k) { rows[static_cast<std::size_t>(k)] = row_of(bins, k); });
    for_each_row(static_cast<int>(outputs_.size()), [&](int output) {
      for (int k = 0; k < count; ++k) add(rows[static_cast<std::size_t>(k)], middle_rad(first + k), output);
    });
  }

  /// The pulse's sum over ranges.
  Row row_of(const ReferenceBins& bins, int azimuth) const {
    const auto n = static_cast<std::size_t>(s_.range_bins);
    Row row{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n, 1)};
    const std::size_t start = static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(bins.n_range);
    const double part_m = spacing_m_ / kTruthParts;
    for (int m = 0; m < s_.range_bins; ++m) {
      const int first = first_range_ + m * kTruthParts;  // sharp bins of this gate
      const double gate_m = s_.r_min_m + (m + 0.5) * spacing_m_;
      double ground = 0, building = 0, sine = 0;
      for (int j = first + kTruthParts / 2 - last_offset_; j < first + kTruthParts / 2 + last_offset_; ++j) {
        if (j < 0 || j >= bins.n_range) continue;
        const double range_m = view_.r_min_m + (j + 0.5) * part_m;
        const double weight = squared_response(range_m - gate_m, range_m);
        const std::size_t at = start + static_cast<std::size_t>(j);
        ground += weight * bins.ground_w[at];
        building += weight * bins.building_w[at];
        sine += weight * bins.sine_w[at];
      }
      const auto gate = static_cast<std::size_t>(m);
      row.ground_w[gate] = ground;
      row.building_w[gate] = building;
      const double mean = ground + building > 0 ? sine / (ground + building) : 0;
      row.cos_elevation[gate] = std::sqrt(std::max(kLeastCosine * kLeastCosine, 1 - mean * mean));
    }
    return row;
  }

  double squared_response(double offset_m, double range_m) const {
    if (s_.pulse.kind == PulseKind::off) return 1;
    const double eclipsed = s_.pulse.eclipse ? std::min(1.0, range_m / response_.half_pulse_m()) : 1;
    const double p = eclipsed * response_.at(offset_m);
    return p * p;
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
    for (std::size_t m = 0; m < row.ground_w.size(); ++m) {
      if (row.ground_w[m] + row.building_w[m] == 0) continue;
      const double g = sharp ? 1 : gain(offset, row.cos_elevation[m]);
      truth_.ground_w[start + m] += g * g * row.ground_w[m];
      truth_.building_w[start + m] += g * g * row.building_w[m];
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
  std::vector<double> outputs_;  // middles, from the sector's start
  TruthBins truth_;
};

}  // namespace

TruthBins integrate_radar_truth(const FramePlan& plan, const AzimuthRuns& runs,
                                const ReferenceSampling& sampling, const Progress& progress) {
  return RadarTruth(plan, runs, sampling).integrate(progress);
}

}  // namespace obliq
