#pragma once
// The core call: plan a frame, render its wedges. README.md beside this file has the pipeline as a picture.
#include <functional>
#include <memory>
#include <stop_token>
#include <string_view>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/pulse_train.h"
#include "server/radar/samples.h"
#include "server/radar/settings.h"
#include "server/radar/targets/target.h"
#include "server/scene/scene.h"

namespace obliq {

class HitObserver;  // server/radar/samples.h
class SharpStore;   // server/radar/beam/echo_rows.h
class Receiver;     // server/radar/receiver/receiver.h
class StageTimes;   // terrain/base/stage_clock.h
struct AirView;     // server/radar/receiver/weather.h

struct Wedge {
  int index = 0;  ///< wedge number within the frame, 0 at the sector's left edge
  BinBlock bins;
  FrameStats stats;
};

struct RenderOptions {
  int threads = 0;                             ///< 0 = all cores
  std::function<void(Wedge&&)> on_wedge;       ///< called as wedges finish, from any thread, one at a time
  std::function<void(PulseTrain&&)> on_train;  ///< of a frame that was recorded, called between wedges
  std::stop_token stop;                        ///< no further wedge is begun after a stop request
  bool iq = true;                              ///< false: I&Q is not computed (faster)
  bool states = true;               ///< false: bins without samples all say not_sampled, which is quicker
  bool labels = false;              ///< whether they are wanted
  bool target_ids = false;          ///< whether BinBlock::target is wanted
  HitObserver* observer = nullptr;  ///< receives every hit of a pixel, for textures
  Surfaces surfaces = Surfaces::all;
  std::uint64_t draw = 0;  ///< names the frame (frame_draw): independent speckle repeats with it
  /// Behind a beam: shares sharp wedges with the renderings before and after it, of one antenna and scene,
  /// or of one that has moved little. Null: shares nothing.
  SharpStore* sharp = nullptr;
  /// The frame's; on_wedge is given what it makes of the bins. Null: the echoes as they are, and no range
  /// normalisation where that is the receiver's (normalises_samples).
  const Receiver* receiver = nullptr;
  /// Vehicles, ships and aircraft among the ground's echoes; null: none.
  const TargetSet* targets = nullptr;
  TargetMoment targets_at{};
  std::uint64_t dwell = 0;      ///< of a scan: names the dwell within its pass, for targets that fluctuate
  bool video8 = false;          ///< wanted of the receiver, in 256 levels;
  bool video16 = false;         ///< in 65,536
  StageTimes* times = nullptr;  ///< given what each thread has spent on what; null: nothing is measured
};

/// Video of several looks, which behind a beam or a pulse is made of a look of its own (BinBlock::look).
inline bool wants_look(const RenderOptions& options, const RadarSettings& settings) {
  return (options.video8 || options.video16) && settings.video.looks > 1;
}

/// What RenderOptions::threads says; 0: all cores.
int thread_count(int threads);

/// Of a radar's frame, by the radar's name and the frame's number.
std::uint64_t frame_draw(std::string_view radar, std::uint64_t counter);

/// What is looked at of its targets.
inline TargetLook target_look(const RenderOptions& options, bool truth = false) {
  return {options.targets_at, options.draw, options.dwell, truth};
}

/// Where the antenna is in the air.
AirView air_view(const ScenePlan& plan);

/// Adds up wedge counts in azimuth order, whatever order the wedges arrive in: the same bits every time.
class FrameSum {
 public:
  explicit FrameSum(const RadarSettings& settings)
      : wedges_(static_cast<std::size_t>(wedge_count(settings.azimuth_bins))) {}
  void add(const Wedge& wedge) { wedges_[static_cast<std::size_t>(wedge.index)] = wedge.stats; }
  FrameStats total() const;

 private:
  std::vector<FrameStats> wedges_;
};

class WedgeVisibility;  // server/radar/visibility/wedge_visibility.h

/// Samples of azimuth bins [range.first, range.first + range.count), the way the plan's frustum looks.
/// `observer` may be null, and so may `profile`, the visibility of the same azimuth bins: a caller that has
/// one hands it in, so that nothing is marched twice. All of them must outlive the source.
std::unique_ptr<SampleSource> make_sample_source(const ScenePlan& plan, AzimuthRange range,
                                                 HitObserver* observer, WedgeVisibility* profile = nullptr);

/// Renders every wedge that overlaps `azimuths`, on several threads, and hands each to on_wedge
/// (server/radar/wedge_threads.cpp). Its threads ask behind the gate of this one (terrain/base/asking.h),
/// though not in on_wedge. Returns false when stopped early.
bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options);

/// A whole frame in memory.
struct Frame {
  BinBlock bins;
  FrameStats stats;
};

/// Renders the azimuth bins of a scene. The same scene, settings, pose and azimuths give the same bits for
/// any thread count. Without a receiver in the options the settings' own serves, of a radar without a name.
/// Throws InputError when the frame cannot be planned.
Frame render(std::shared_ptr<const Scene> scene, SettingsPtr settings, const Pose& pose,
             AzimuthRange azimuths, const RenderOptions& options = {});

}  // namespace obliq
