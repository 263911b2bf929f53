#pragma once
#include <memory>
#include <string>

#include "server/radar/geometry/pose.h"
#include "server/radar/settings.h"
#include "server/scene/scene.h"
#include "server/timing/timing_report.h"

namespace obliq {

/// What a frame is of.
struct TimedFrame {
  std::shared_ptr<const Scene> scene;
  SettingsPtr settings;
  Pose pose;
  std::string radar;
  std::string scene_name;
  int threads = 0;
};

/// Frames as the daemon makes them, planned, rendered, encoded with all planes and sent over the loopback,
/// with and without probes in turns for a few seconds. All of the timing but the scene's part.
Timing time_frames(const TimedFrame& frame);

}  // namespace obliq
