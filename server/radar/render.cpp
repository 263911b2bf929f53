#include "server/radar/render.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "server/radar/echo/echo_bins.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/sweep/sweep_samples.h"
#include "server/radar/visibility/bin_states.h"
#include "server/radar/visibility/coverage.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "terrain/base/errors.h"
#include "terrain/base/stage_clock.h"

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

void count_lit(const BinBlock& bins, FrameStats& stats) {
  const auto of = [&](BinState state) {
    return static_cast<std::uint64_t>(std::ranges::count(bins.state, static_cast<std::uint8_t>(state)));
  };
  stats.unsampled_bins = of(BinState::not_sampled);
  stats.lit_bins = of(BinState::sampled) + stats.unsampled_bins;
}

/// The wedge that a thread has in hand, and its buffers, reused from wedge to wedge.
class WedgeWork {
 public:
  WedgeWork(const FramePlan& plan, const FrameTables& tables, Surfaces surfaces)
      : plan_(plan), bins_(plan, tables.scattering, tables.speckle, {}, surfaces) {}

  bool begun() const { return source_ != nullptr; }

  void begin(int index, SampleTap* tap) {
    const int bin = index * kWedgeAzimuthBins;
    const AzimuthRange range{bin, std::min(kWedgeAzimuthBins, plan_.settings().azimuth_bins - bin)};
    {
      const StageProbe probe(Stage::bin);
      wedge_ = {};
      wedge_.index = index;
      wedge_.bins = BinBlock(range.first, range.count, plan_.bins().n_range);
      bins_.restart(range);
    }
    profile_.emplace(plan_, range);
    source_ = make_sample_source(plan_, range, tap, &*profile_);
  }

  /// True when the wedge has all its samples; false when `may_go_on` said no after a batch.
  template <typename MayGoOn>
  bool take(const MayGoOn& may_go_on) {
    for (;;) {
      if (!source_->next(samples_, wedge_.stats)) return true;
      const StageProbe probe(Stage::scatter);
      wedge_.stats.samples += bins_.add(samples_);
      if (!may_go_on()) return false;
    }
  }

  Wedge finish(bool states) {
    source_.reset();
    {
      const StageProbe probe(Stage::bin);
      bins_.write(wedge_.bins);
    }
    const StageProbe probe(Stage::states);
    for (int k = 0; k < wedge_.bins.n_azimuth; ++k) {
      const GroundArea area = ground_area(plan_, wedge_.bins.first_azimuth + k);
      wedge_.stats.sector_area_m2 += area.sector_m2;
      wedge_.stats.covered_area_m2 += area.covered_m2;
    }
    if (states) {
      decide_states(plan_, *profile_, wedge_.bins);
      count_lit(wedge_.bins, wedge_.stats);
    }
    return std::move(wedge_);
  }

 private:
  const FramePlan& plan_;
  SampleBatch samples_;
  WedgeBins bins_;
  Wedge wedge_;
  std::optional<WedgeVisibility> profile_;
  std::unique_ptr<SampleSource> source_;
};

}  // namespace

class BegunWedges {
 public:
  BegunWedges(const FramePlan& plan, int first, int threads)
      : tables(plan), next(first), work(static_cast<std::size_t>(threads)) {}

  const FrameTables tables;
  std::atomic<int> next;
  std::vector<std::unique_ptr<WedgeWork>> work;  // each thread's
};

FrameStats FrameSum::total() const {
  FrameStats total;
  for (const FrameStats& wedge : wedges_) total.add(wedge);
  return total;
}

std::unique_ptr<SampleSource> make_sample_source(const FramePlan& plan, AzimuthRange range, SampleTap* tap,
                                                 WedgeVisibility* profile) {
  if (plan.settings().frustum == FrustumKind::sweep) return std::make_unique<SweepSamples>(plan, range);
  return std::make_unique<RaySamples>(plan, range, tap, profile);
}

bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options) {
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = std::min(wedge_count(plan.settings().azimuth_bins),
                           (azimuths.first + azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::shared_ptr<BegunWedges> begun;
  if (options.pause) begun = std::exchange(options.pause->begun, nullptr);
  if (!begun) begun = std::make_shared<BegunWedges>(plan, first, threads);
  std::atomic<bool> paused{false};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  std::mutex delivery;

  // A pause is due when a thread has done its share: a wedge has one thread, and may be all that there is.
  const auto work_until_done = [&](std::unique_ptr<WedgeWork>& work) {
    const StageClock clock(options.times);
    int batches = options.pause ? std::max(1, options.pause->batches / threads) : 0;
    const auto may_go_on = [&] {
      if (options.stop.stop_requested()) return false;
      if (!options.pause) return true;
      return --batches > 0 && !(options.pause->is_due && options.pause->is_due());
    };
    try {
      if (!work) work = std::make_unique<WedgeWork>(plan, begun->tables, options.surfaces);
      while (!options.stop.stop_requested() && !failed) {
        if (!work->begun()) {
          const int index = begun->next++;
          if (index >= end) return;
          if (options.before_wedge) options.before_wedge(index);
          work->begin(index, options.tap);
        }
        if (!work->take(may_go_on)) {
          if (!options.stop.stop_requested()) paused = true;
          return;
        }
        Wedge wedge = work->finish(options.states);
        std::unique_lock lock(delivery, std::defer_lock);
        {
          const StageProbe probe(Stage::wait);
          lock.lock();
        }
        if (options.on_wedge && !failed) options.on_wedge(std::move(wedge));
      }
    } catch (...) {
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };

  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < begun->work.size(); ++t)
      helpers.emplace_back([&, t] { work_until_done(begun->work[t]); });
    work_until_done(begun->work[0]);
  }
  if (failure) std::rethrow_exception(failure);
  if (paused && !options.stop.stop_requested()) options.pause->begun = std::move(begun);
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
