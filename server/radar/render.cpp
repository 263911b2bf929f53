#include "server/radar/render.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "server/radar/batches.h"
#include "server/radar/frame_plan.h"
#include "server/radar/sample_source.h"
#include "server/radar/scattering.h"
#include "server/radar/speckle.h"
#include "server/radar/wedge_bins.h"
#include "server/radar/wedge_profile.h"
#include "terrain/errors.h"

namespace obliq {
namespace {

/// What the wedges of a frame share besides the plan.
struct FrameTables {
  ScatteringTable scattering;
  SpeckleField speckle;

  explicit FrameTables(const FramePlan& plan)
      : scattering(plan.scene().materials(), plan.wavelength_m()),
        speckle(plan.scene().world(), plan.sector().antenna_m, plan.wavelength_m(),
                plan.bins().range_spacing_m, plan.bins().azimuth_width_rad, plan.settings().speckle_seed) {}
};

/// Gives every bin without samples its state, and measures coverage along the bins' centres. An azimuth bin
/// that needs no states is marched along its centre alone.
void decide_states(bool states, WedgeProfile& profile, Wedge& wedge) {
  const auto n_range = static_cast<std::size_t>(wedge.bins.n_range);
  const auto undecided = [](std::uint8_t value) {
    return value != static_cast<std::uint8_t>(BinState::sampled);
  };
  for (int a = 0; a < wedge.bins.n_azimuth; ++a) {
    const int azimuth_bin = wedge.bins.first_azimuth + a;
    const WedgeProfile::Area& area = profile.area(azimuth_bin);
    wedge.stats.sector_area_m2 += area.sector_m2;
    wedge.stats.covered_area_m2 += area.covered_m2;
    std::uint8_t* state = wedge.bins.state.data() + static_cast<std::size_t>(a) * n_range;
    if (!states || std::none_of(state, state + n_range, undecided)) continue;
    const BinMarks& marks = profile.marks(azimuth_bin);
    for (std::size_t r = 0; r < n_range; ++r) {
      if (!undecided(state[r])) continue;
      const BinState decided = marks.visible[r]   ? BinState::not_sampled
                               : marks.present[r] ? BinState::shadow
                                                  : BinState::no_surface;
      state[r] = static_cast<std::uint8_t>(decided);
    }
  }
}

/// The buffers of one thread, reused from wedge to wedge.
struct Workspace {
  SampleBatch samples;
  WedgeBins bins;

  Workspace(const FramePlan& plan, const FrameTables& tables, Surfaces surfaces)
      : bins(plan, tables.scattering, tables.speckle, {}, surfaces) {}
};

Wedge render_wedge(const FramePlan& plan, int index, AzimuthRange range, const RenderOptions& options,
                   Workspace& work) {
  Wedge wedge;
  wedge.index = index;
  wedge.bins = BinBlock(range.first, range.count, plan.bins().n_range);
  work.bins.restart(range);
  WedgeProfile profile(plan, range);
  const auto source = make_sample_source(plan, range, options.tap, &profile);
  while (source->next(work.samples, wedge.stats)) wedge.stats.samples += work.bins.add(work.samples);
  work.bins.write(wedge.bins);
  decide_states(options.states, profile, wedge);
  return wedge;
}

}  // namespace

int wedge_count(const RadarSettings& settings) {
  return (settings.azimuth_bins + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins;
}

FrameStats FrameSum::total() const {
  FrameStats total;
  for (const FrameStats& wedge : wedges_) total.add(wedge);
  return total;
}

bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options) {
  const FrameTables tables(plan);
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = std::min(wedge_count(plan.settings()),
                           (azimuths.first + azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  std::atomic<int> next{first};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  std::mutex delivery;

  const auto work_until_done = [&] {
    const auto work = std::make_unique<Workspace>(plan, tables, options.surfaces);
    for (int index = next++; index < end; index = next++) {
      if (options.stop.stop_requested() || failed) return;
      try {
        if (options.before_wedge) options.before_wedge(index);
        const int bin = index * kWedgeAzimuthBins;
        const AzimuthRange range{bin, std::min(kWedgeAzimuthBins, plan.settings().azimuth_bins - bin)};
        Wedge wedge = render_wedge(plan, index, range, options, *work);
        const std::scoped_lock lock(delivery);
        if (options.on_wedge && !failed) options.on_wedge(std::move(wedge));
      } catch (...) {
        if (!failed.exchange(true)) failure = std::current_exception();
        return;
      }
    }
  };

  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < threads; ++t) helpers.emplace_back(work_until_done);
    work_until_done();
  }
  if (failure) std::rethrow_exception(failure);
  return !options.stop.stop_requested();
}

Frame render(std::shared_ptr<const Scene> scene, SettingsPtr settings, const Pose& pose,
             AzimuthRange azimuths, const RenderOptions& options) {
  const PlanResult planned = plan_frame(std::move(scene), std::move(settings), pose);
  if (!planned.plan) throw InputError(all_text(planned.errors));
  const FramePlan& plan = *planned.plan;
  Frame frame;
  frame.bins = BinBlock(azimuths.first, azimuths.count, plan.bins().n_range);
  FrameSum sum(plan.settings());
  RenderOptions with_copy = options;
  with_copy.on_wedge = [&](Wedge&& wedge) {
    sum.add(wedge);
    copy_azimuths(wedge.bins, frame.bins);
    if (options.on_wedge) options.on_wedge(std::move(wedge));
  };
  render_wedges(plan, azimuths, with_copy);
  frame.stats = sum.total();
  return frame;
}

}  // namespace obliq
