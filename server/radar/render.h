#pragma once
// The core call. Reads top to bottom like the pipeline it is: plan the frame, then wedge by wedge find
// samples, scatter, bin.
#include <functional>
#include <limits>
#include <memory>
#include <stop_token>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/pose.h"
#include "server/radar/settings.h"
#include "server/scene/scene.h"

namespace obliq {

/// Azimuth bins are rendered in wedges of this many: a task owns its wedge's bins, so the bits do not depend
/// on the thread count. Fixed, because the order of sums inside a wedge follows from it.
constexpr int kWedgeAzimuthBins = 8;

struct AzimuthRange {
  int first = 0;
  int count = 0;
};

class FramePlan;   // server/radar/frame_plan.h
class SampleTap;   // server/radar/sample_tap.h
class StageTimes;  // terrain/stage_clock.h

/// The geometry of a frame, worked out once for all its wedges. `plan` is null when `errors` is not empty.
struct PlanResult {
  std::shared_ptr<const FramePlan> plan;
  std::vector<FieldError> errors;
};
PlanResult plan_frame(std::shared_ptr<const Scene> scene, const SettingsPtr& settings, const Pose& pose);

struct Wedge {
  int index = 0;  ///< wedge number within the frame, 0 at the sector's left edge
  BinBlock bins;
  FrameStats stats;
};

/// Which returns are binned. All surfaces hide what lies behind them, whatever is binned.
enum class Surfaces { all, ground, buildings };

/// Wedges that are begun and not finished (server/radar/render.cpp).
class BegunWedges;

/// Lets a rendering pause in the middle of its wedges, so that others get their turn. The bits stay the same.
struct RenderPause {
  /// Of at most kBatch rays or samples, or the buildings of one column of the sweep; for all threads
  /// together, at least one each.
  int batches = std::numeric_limits<int>::max();
  /// Asked after each batch, from any thread; true: pause now. May be empty.
  std::function<bool()> is_due{};
  /// Not null: it has paused, and the same call goes on. Not to outlive the plan.
  std::shared_ptr<BegunWedges> begun;
};

struct RenderOptions {
  int threads = 0;                        ///< 0 = all cores
  std::function<void(Wedge&&)> on_wedge;  ///< called as wedges finish, from any thread, one at a time
  std::function<void(int)> before_wedge;  ///< test hook: called with the wedge index before it is rendered
  std::stop_token stop;                   ///< no further wedge or batch is begun after a stop request
  bool states = true;            ///< false: bins without samples all say not_sampled, which is quicker
  SampleTap* tap = nullptr;      ///< receives every hit of a pixel, for textures
  RenderPause* pause = nullptr;  ///< null: does not pause
  Surfaces surfaces = Surfaces::all;
  StageTimes* times = nullptr;  ///< given what each thread has spent on what; null: nothing is measured
};

int wedge_count(const RadarSettings& settings);

/// Adds up wedge counts in azimuth order, whatever order the wedges arrive in: the same bits every time.
class FrameSum {
 public:
  explicit FrameSum(const RadarSettings& settings)
      : wedges_(static_cast<std::size_t>(wedge_count(settings))) {}
  void add(const Wedge& wedge) { wedges_[static_cast<std::size_t>(wedge.index)] = wedge.stats; }
  FrameStats total() const;

 private:
  std::vector<FrameStats> wedges_;
};

/// Renders every wedge that overlaps `azimuths` and hands each to on_wedge. Returns false when stopped early;
/// options.pause tells whether there is more to come.
bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options);

/// A whole frame in memory.
struct Frame {
  BinBlock bins;
  FrameStats stats;
};

/// Renders the azimuth bins of a scene. The same scene, settings, pose and azimuths give the same bits for
/// any thread count. Throws InputError when the frame cannot be planned.
Frame render(std::shared_ptr<const Scene> scene, SettingsPtr settings, const Pose& pose,
             AzimuthRange azimuths, const RenderOptions& options = {});

}  // namespace obliq
