#include "server/explain/measurement.h"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

#include "server/radar/render.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

constexpr int kWedges = 8;  ///< of 8 azimuth bins: 64
/// A plane of 16384 x 32768 pixels still numbers its pixels in 32 bits.
constexpr int kMostColumns = 32768;
constexpr int kMostRows = 32768;

/// Processor time of this thread: what a wedge costs, however busy the machine is.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Every wedge once, each on one thread. Returns the processor time of all.
double render_once(const FramePlan& plan, const std::vector<AzimuthRange>& wedges, int workers, bool states,
                   WedgePlanes& planes) {
  const auto n_range = static_cast<std::size_t>(plan.bins().n_range);
  std::vector<std::size_t> first_bin;
  std::size_t bins = 0;
  for (const AzimuthRange& wedge : wedges) {
    first_bin.push_back(bins);
    bins += static_cast<std::size_t>(wedge.count) * n_range;
  }
  planes.power_w.resize(bins);
  planes.iq.resize(bins);
  planes.count.resize(bins);
  std::vector<FrameStats> stats(wedges.size());
  std::vector<double> seconds(wedges.size());
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto work = [&] {
    for (std::size_t w = next++; w < wedges.size(); w = next++) {
      RenderOptions options;
      options.threads = 1;
      options.states = states;
      options.on_wedge = [&](Wedge&& wedge) {
        std::ranges::copy(wedge.bins.power_w,
                          planes.power_w.begin() + static_cast<std::ptrdiff_t>(first_bin[w]));
        std::ranges::copy(wedge.bins.iq, planes.iq.begin() + static_cast<std::ptrdiff_t>(first_bin[w]));
        std::ranges::copy(wedge.bins.count, planes.count.begin() + static_cast<std::ptrdiff_t>(first_bin[w]));
        stats[w] = wedge.stats;
      };
      try {
        const double start = thread_seconds();
        render_wedges(plan, wedges[w], options);
        seconds[w] = thread_seconds() - start;
      } catch (...) {
        const std::scoped_lock lock(failing);
        failure = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < workers; ++t) helpers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  planes.stats = {};
  for (const FrameStats& one : stats) planes.stats.add(one);
  return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

constexpr double kOneDecibel = 1.2589254117941673;  // 10^0.1

}  // namespace

int columns_factor(const RadarSettings& settings, double cell_m) {
  constexpr double kMostFactor = 8;
  const double width_m = settings.r_max_m * settings.sector_deg * kDegree_rad / settings.azimuth_bins;
  const double columns = width_m / (cell_m / 2);
  return static_cast<int>(std::clamp(std::ceil(columns / kComparisonDensity.columns), 1.0, kMostFactor));
}

std::vector<AzimuthRange> even_wedges(const RadarSettings& settings) {
  const int all = wedge_count(settings.azimuth_bins);
  const int chosen = std::min(all, kWedges);
  std::vector<AzimuthRange> wedges;
  for (int n = 0; n < chosen; ++n) {
    const int index = static_cast<int>((2LL * n + 1) * all / (2LL * chosen));
    const int first = index * kWedgeAzimuthBins;
    wedges.push_back({first, std::min(kWedgeAzimuthBins, settings.azimuth_bins - first)});
  }
  return wedges;
}

int threads_of(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

int azimuth_bins_in(const std::vector<AzimuthRange>& wedges) {
  int bins = 0;
  for (const AzimuthRange& wedge : wedges) bins += wedge.count;
  return bins;
}

WedgePlanes render_sample(const FramePlan& plan, const std::vector<AzimuthRange>& wedges, int threads,
                          int repetitions, bool states) {
  WedgePlanes planes;
  const int all_threads = threads_of(threads);
  const int workers = std::min(all_threads, static_cast<int>(wedges.size()));
  // From some wedges to all, and from one thread to all of them.
  const double scale = static_cast<double>(plan.bins().n_azimuth) / azimuth_bins_in(wedges) / all_threads;
  double slowest_s = 0;
  for (int n = 0; n < repetitions; ++n) {
    const double frame_s = scale * render_once(plan, wedges, workers, states, planes);
    planes.frame_s = n == 0 ? frame_s : std::min(planes.frame_s, frame_s);
    slowest_s = std::max(slowest_s, frame_s);
  }
  planes.spread_s = slowest_s - planes.frame_s;
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

RangeBins range_bins_of(const BinGrid& bins) {
  return {bins.r_min_m, bins.range_spacing_m, bins.n_range, false};
}

SpeckleMeasure measure_speckle(const WedgePlanes& planes) {
  SpeckleMeasure measure;
  std::vector<std::uint32_t> samples;
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
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  measure.median_samples = *middle;
  return measure;
}

double PowerChange::total_db() const { return 10 * std::log10(total_ratio); }

PowerChange larger_of(const PowerChange& a, const PowerChange& b) {
  PowerChange larger;
  larger.lit = std::max(a.lit, b.lit);
  larger.median_db = std::max(a.median_db, b.median_db);
  larger.percentile95_db = std::max(a.percentile95_db, b.percentile95_db);
  larger.over_1_db = std::max(a.over_1_db, b.over_1_db);
  larger.vanished = std::max(a.vanished, b.vanished);
  larger.appeared = std::max(a.appeared, b.appeared);
  larger.total_ratio = std::abs(a.total_db()) > std::abs(b.total_db()) ? a.total_ratio : b.total_ratio;
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

}  // namespace obliq
