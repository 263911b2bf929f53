#include "server/explain/measurement.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <future>

#include "server/radar/render.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

/// A plane of 16384 x 32768 pixels still numbers its pixels in 32 bits.
constexpr int kMostColumns = 32768;
constexpr int kMostRows = 32768;

void append(WedgePlanes& to, const auto& bins, const FrameStats& stats) {
  const auto add = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  add(to.power_w, bins.power_w);
  add(to.iq, bins.iq);
  add(to.count, bins.count);
  to.stats.add(stats);
}

/// Every run once, each on one thread. Returns the processor time of all, however busy the machine is.
double render_once(const FramePlan& plan, const AzimuthRuns& runs, int workers, bool states,
                   WedgePlanes& planes) {
  std::vector<WedgePlanes> rendered(runs.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < runs.size(); k = next++) {
      RenderOptions options;
      options.threads = 1;
      options.states = states;
      options.on_wedge = [&](Wedge&& wedge) { append(rendered[k], wedge.bins, wedge.stats); };
      render_wedges(plan, runs[k], options);
    }
  };
  const std::clock_t start = std::clock();
  {
    std::vector<std::future<void>> threads;
    for (int t = 0; t < workers; ++t) threads.push_back(std::async(std::launch::async, work));
    for (auto& thread : threads) thread.get();
  }
  const double processor_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  planes = {};
  for (const WedgePlanes& part : rendered) append(planes, part, part.stats);
  return processor_s;
}

constexpr double kOneDecibel = 1.2589254117941673;  // 10^0.1

/// By the shoelace formula; holes count as built over.
double outline_area_m2(const Buildings& buildings, const Building& building) {
  const std::uint32_t begin = buildings.ring_start[building.first_ring];
  const std::uint32_t end = buildings.ring_start[building.first_ring + 1];
  double doubled = 0;
  for (std::uint32_t k = begin; k < end; ++k) {
    // Differences from the first corner, since the outline is far smaller than its distance from the origin.
    const glm::dvec2 a(buildings.ring_xz_m[k] - buildings.ring_xz_m[begin]);
    const glm::dvec2 b(buildings.ring_xz_m[k + 1 < end ? k + 1 : begin] - buildings.ring_xz_m[begin]);
    doubled += a.x * b.y - b.x * a.y;
  }
  return std::abs(doubled) / 2;
}

constexpr int kDistances = 512;  ///< along each azimuth, evenly from under the antenna to r_max

}  // namespace

int columns_factor(const RadarSettings& settings, double cell_m) {
  constexpr double kMostFactor = 8;
  const double width_m = settings.r_max_m * settings.sector_deg * kDegree_rad / settings.azimuth_bins;
  const double columns = width_m / (cell_m / 2);
  return static_cast<int>(std::clamp(std::ceil(columns / kComparisonDensity.columns), 1.0, kMostFactor));
}

WedgePlanes render_sample(const FramePlan& plan, const AzimuthRuns& runs, int threads, int repetitions,
                          bool states) {
  WedgePlanes planes;
  const int all_threads = thread_count(threads);
  const int workers = std::min(all_threads, static_cast<int>(runs.size()));
  // From some azimuths to all, and from one thread to all of them.
  const double scale = static_cast<double>(plan.bins().n_azimuth) / azimuth_count(runs) / all_threads;
  std::vector<double> frames_s;
  for (int n = 0; n < repetitions; ++n)
    frames_s.push_back(scale * render_once(plan, runs, workers, states, planes));
  const auto [least, most] = std::ranges::minmax(frames_s);
  planes.frame_s = least;
  planes.spread_s = most - least;
  return planes;
}

SampleKind comparison_source(const RadarSettings& settings, const std::vector<Material>& materials) {
  if (flat_plates(materials).empty()) return {FrustumKind::sweep, PlateKind::spread};
  return {settings.frustum, settings.plates};
}

SampleKind ray_source(const RadarSettings& settings, PlateKind plates) {
  return {settings.frustum == FrustumKind::sweep ? FrustumKind::oblique : settings.frustum, plates};
}

RadarSettings comparison_settings(RadarSettings settings, SampleKind source, Density density) {
  settings.frustum = source.frustum;
  settings.plates = source.plates;
  settings.pixel_columns = std::min(kMostColumns, density.columns * settings.azimuth_bins);
  settings.pixel_rows =
      static_cast<int>(std::min(1.0 * kMostRows, std::ceil(density.rows * settings.range_bins)));
  settings.range_normalisation = false;
  settings.power_w = 1;
  settings.gain_db = 0;
  // Only powers are compared: the quicker one.
  settings.speckle = source.frustum == FrustumKind::sweep ? SpeckleKind::ground : SpeckleKind::geometric;
  return settings;
}

SpeckleMeasure measure_speckle(const WedgePlanes& planes) {
  SpeckleMeasure measure;
  std::vector<double> samples;
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < planes.power_w.size(); ++k) {
    if (!(planes.power_w[k] > 0)) continue;
    const double relative = std::norm(std::complex<double>(planes.iq[k])) / planes.power_w[k];
    sum += relative;
    squares += relative * relative;
    samples.push_back(planes.count[k]);
  }
  if (samples.empty() || !(sum > 0)) return measure;
  const auto n = static_cast<double>(samples.size());
  measure.contrast = std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n))) / (sum / n);
  measure.median_samples = upper_median(samples);
  return measure;
}

double upper_median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double PowerChange::total_db() const { return 10 * std::log10(total_ratio); }

PowerChange larger_of(const PowerChange& a, const PowerChange& b) {
  PowerChange larger = std::abs(a.total_db()) > std::abs(b.total_db()) ? a : b;
  larger.lit = std::max(a.lit, b.lit);
  for (const auto measure : {&PowerChange::median_db, &PowerChange::percentile95_db, &PowerChange::over_1_db,
                             &PowerChange::vanished, &PowerChange::appeared})
    larger.*measure = std::max(a.*measure, b.*measure);
  return larger;
}

PowerChange power_change(const std::vector<double>& power_w, const std::vector<double>& changed_w,
                         const RangeBins& ranges) {
  const BinErrors there = bin_errors(changed_w, power_w, ranges);
  const BinErrors back = bin_errors(power_w, changed_w, ranges);
  PowerChange change;
  change.lit = there.lit;
  change.median_db = there.median_db;
  change.percentile95_db = there.percentile95_db;
  if (there.truth_energy_w > 0) change.total_ratio = there.energy_w / there.truth_energy_w;
  if (there.lit == 0) return change;
  const auto lit = static_cast<double>(there.lit);
  change.vanished = static_cast<double>(there.gaps) / lit;
  change.appeared = static_cast<double>(back.gaps) / lit;
  std::uint64_t changed = 0;
  for (std::size_t k = 0; k < power_w.size(); ++k) {
    const int bin = static_cast<int>(k % static_cast<std::size_t>(ranges.n_range));
    if (!(ranges.q(bin, power_w[k]) >= 1e-3 * there.median_q && power_w[k] > 0)) continue;
    const double ratio = changed_w[k] / power_w[k];
    if (ratio > kOneDecibel || ratio < 1 / kOneDecibel) ++changed;
  }
  change.over_1_db = static_cast<double>(changed) / lit;
  return change;
}

std::vector<std::uint8_t> materials_used(const World& world) {
  std::array<bool, 256> used{};
  for (const std::uint8_t id : world.surface_material) used[id] = true;
  for (const Building& building : world.buildings.list) used[building.material] = true;
  std::vector<std::uint8_t> ids;
  for (std::size_t id = 1; id < used.size(); ++id)
    if (used[id]) ids.push_back(static_cast<std::uint8_t>(id));
  return ids;
}

BuildingSizes median_sizes(const Buildings& buildings) {
  std::vector<double> heights_m, sides_m;
  for (const Building& building : buildings.list) {
    sides_m.push_back(std::sqrt(outline_area_m2(buildings, building)));
    heights_m.push_back(2 * (static_cast<double>(building.roof_y_m) - building.walls_y_m));
  }
  return {upper_median(heights_m), upper_median(sides_m)};
}

GroundProbes::GroundProbes(const FramePlan& plan, const AzimuthRuns& runs) {
  const HeightGrid& grid = plan.scene().world().grid;
  const Sector& sector = plan.sector();
  for (const AzimuthRange& run : runs) {
    for (int bin = run.first; bin < run.first + run.count; ++bin) {
      const double bearing = sector.bearing_rad + plan.bins().azimuth_edge_rad(bin + 0.5);
      for (int n = 1; n <= kDistances; ++n) {
        const double ground_m = sector.r_max_m * n / kDistances;
        const double x = sector.antenna_m.x + ground_m * std::sin(bearing);
        const double z = sector.antenna_m.z + ground_m * std::cos(bearing);
        const double below = sector.antenna_m.y - grid.height_at_m(x, z);
        const double slant = std::hypot(ground_m, below);
        if (slant >= sector.r_min_m && slant <= sector.r_max_m) points_.push_back({x, z, below, slant});
      }
    }
  }
}

GroundShift GroundProbes::shift_in(const World& world, const Pose& pose) const {
  GroundShift shift;
  const glm::dvec3& antenna = pose.antenna.m;
  for (const Point& p : points_) {
    const double below = antenna.y - world.grid.height_at_m(p.x_m, p.z_m);
    if (std::isnan(below)) continue;
    const double ground_m = std::hypot(p.x_m - antenna.x, p.z_m - antenna.z);
    shift.slant_m = std::max(shift.slant_m, std::abs(std::hypot(ground_m, below) - p.slant_m));
    shift.vertical_m = std::max(shift.vertical_m, std::abs(below - p.below_antenna_m));
  }
  return shift;
}

}  // namespace obliq
