#include "server/accuracy/measure_frame.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "server/radar/echo/sea_clutter.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

struct RenderedFrame {
  std::shared_ptr<const FramePlan> plan;  ///< knows which buildings were seen
  BinBlock bins;
  FrameStats stats;
  double time_s = 0;
  double processor_s = 0;
};

std::shared_ptr<const FramePlan> plan_or_throw(const View& view) {
  // What is compared are the ground's echoes: without receiver and weather, but for
  // what makes the sea.
  auto settings = std::make_shared<SettingsSnapshot>(*view.settings);
  settings->settings.receiver = {};
  settings->settings.atmosphere.rain_mm_h = 0;
  settings->settings.atmosphere.gas = false;
  settings->settings.sea.shape = 0;
  if (!(sea_state(settings->settings) > 0)) settings->settings.atmosphere.wind_m_s = 0;
  const PlanResult planned = plan_frame(view.scene, settings, view.pose);
  if (!planned.plan) throw InputError(all_text(planned.errors));
  return planned.plan;
}

/// Plans and renders a whole frame, as the server does for a client, and says how long that took.
RenderedFrame timed_frame(const View& view, bool states, int threads) {
  const RadarSettings& settings = view.settings->settings;
  RenderedFrame frame;
  frame.bins = BinBlock(0, settings.azimuth_bins, settings.range_bins);
  const std::clock_t processor_start = std::clock();
  const auto start = std::chrono::steady_clock::now();
  frame.plan = plan_or_throw(view);
  FrameSum sum(settings);
  RenderOptions options;
  options.threads = threads;
  options.states = states;
  options.on_wedge = [&](Wedge&& wedge) {
    copy_azimuths(wedge.bins, frame.bins);
    sum.add(wedge);
  };
  render_wedges(*frame.plan, {0, settings.azimuth_bins}, options);
  frame.stats = sum.total();
  frame.time_s = seconds_since(start);
  frame.processor_s = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  return frame;
}

/// Collects the times of frames of one kind.
class Timer {
 public:
  void add(const RenderedFrame& frame) {
    times_s_.push_back(frame.time_s);
    processor_s_.push_back(frame.processor_s);
  }
  FrameTime summary() {
    std::ranges::sort(times_s_);
    const std::size_t n = times_s_.size();
    return {times_s_.front(), (times_s_[(n - 1) / 2] + times_s_[n / 2]) / 2,
            *std::ranges::min_element(processor_s_)};
  }

 private:
  std::vector<double> times_s_;
  std::vector<double> processor_s_;
};

/// The power of some azimuths and kinds of surface: [azimuth_count(runs)][n_range].
std::vector<double> render_runs(const FramePlan& plan, const AzimuthRuns& runs, Surfaces surfaces,
                                int threads) {
  std::vector<double> power_w;
  for (const AzimuthRange& run : runs) {
    BinBlock block(run.first, run.count, plan.bins().n_range);
    RenderOptions options;
    options.threads = threads;
    options.states = false;
    options.surfaces = surfaces;
    options.on_wedge = [&](Wedge&& wedge) { copy_azimuths(wedge.bins, block); };
    render_wedges(plan, run, options);
    power_w.insert(power_w.end(), block.power_w.begin(), block.power_w.end());
  }
  return power_w;
}

void fill_errors(const View& view, const TruthBins& truth, const std::vector<std::uint32_t>& match,
                 const FramePlan& plan, const std::vector<double>& power_w, int threads,
                 FrameMeasurement& measured) {
  const RangeBins ranges = range_bins(view.settings->settings);
  const auto compare = [&](Returns returns, const std::vector<double>& frame_w) {
    measured.errors[static_cast<int>(returns)].bins = bin_errors(frame_w, truth.power_w(returns), ranges);
  };
  compare(Returns::all, power_w);
  measured.has_buildings = !truth.buildings.empty();
  if (!measured.has_buildings) {
    measured.errors[static_cast<int>(Returns::terrain)] = measured.errors[static_cast<int>(Returns::all)];
    return;
  }
  const BuildingErrors missed = missed_buildings(truth.buildings, [&](std::uint32_t i) {
    return match[i] != kNoBuilding && plan.looks_at().seen().has(match[i]);
  });
  measured.errors[static_cast<int>(Returns::all)].buildings = missed;
  measured.errors[static_cast<int>(Returns::buildings)].buildings = missed;
  const auto fresh = plan_or_throw(view);
  compare(Returns::terrain, render_runs(*fresh, truth.runs, Surfaces::ground, threads));
  compare(Returns::buildings, render_runs(*fresh, truth.runs, Surfaces::buildings, threads));
}

}  // namespace

FrameMeasurement measure_frame(const View& view, const TruthBins& truth,
                               const std::vector<std::uint32_t>& match, const MeasureOptions& options) {
  FrameMeasurement measured;
  (void)timed_frame(view, true, options.threads);  // caches, page tables, clock frequency
  Timer no_states;
  for (int k = 0; k < options.repeats; ++k) no_states.add(timed_frame(view, false, options.threads));
  measured.no_states = no_states.summary();
  Timer all_planes;
  RenderedFrame frame;
  for (int k = 0; k < options.repeats; ++k) {
    frame = timed_frame(view, true, options.threads);
    all_planes.add(frame);
  }
  measured.all_planes = all_planes.summary();
  measured.stats = frame.stats;
  fill_errors(view, truth, match, *frame.plan, power_of_runs(frame.bins, truth.runs), options.threads,
              measured);
  return measured;
}

TruthBins render_truth(const View& view, const AzimuthRuns& runs, int threads) {
  TruthBins truth;
  truth.runs = runs;
  truth.n_range = view.settings->settings.range_bins;
  const auto plan = plan_or_throw(view);
  truth.ground_w = render_runs(*plan, runs, Surfaces::ground, threads);
  truth.building_w = render_runs(*plan, runs, Surfaces::buildings, threads);
  truth.buildings.resize(view.scene->world().buildings.list.size());
  for (std::uint32_t i = 0; i < truth.buildings.size(); ++i)
    if (plan->looks_at().seen().has(i)) truth.buildings[i] = {1, 1, 1};
  return truth;
}

FrameMeasurement measure_errors(const View& view, const TruthBins& truth,
                                const std::vector<std::uint32_t>& match, int threads) {
  FrameMeasurement measured;
  const auto plan = plan_or_throw(view);
  fill_errors(view, truth, match, *plan, render_runs(*plan, truth.runs, Surfaces::all, threads), threads,
              measured);
  return measured;
}

}  // namespace obliq
