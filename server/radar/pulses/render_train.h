#pragma once
#include <memory>
#include <optional>

#include "server/radar/frame_plan.h"
#include "server/radar/pulse_train.h"
#include "server/radar/render.h"
#include "server/radar/settings.h"

namespace obliq {

struct RenderedTrain {
  PulseTrain train;
  FrameStats stats;  ///< of what was looked at for it, and of its azimuths' ground
};

/// A train of pulses (radar.mode = "pulses"): the ground of all trips, targets, and what the options'
/// receiver makes of each pulse. The same bits for any number of threads, and whether or not rows are shared
/// with the dwells beside it. Nothing when stopped. Throws InputError where an echo's trip cannot be planned.
std::optional<RenderedTrain> render_train(const std::shared_ptr<const Scene>& scene, const FramePlan& plan,
                                          const TrainLook& look, const RenderOptions& options);

/// The train of a frame that is rendered once: through the middle of its sector, where its antenna turns over
/// it.
TrainLook train_of_frame(const RadarSettings& settings);

/// Farther than this from an antenna nothing of a scene is seen: slant range of the farther of the horizon
/// of its highest ground and the end of what is loaded.
double farthest_seen_m(const Scene& scene, const Pose& pose);

}  // namespace obliq
