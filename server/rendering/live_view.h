#pragma once
#include <cstdint>
#include <memory>

#include "server/flight/pose_time_line.h"
#include "server/radar/settings.h"

namespace obliq::net {

/// How a live radar looks, from the next frame on. Never changes once made.
struct LiveView {
  SettingsPtr settings;
  PoseSettings pose;
  std::int64_t pose_received_ns = 0;
  std::shared_ptr<const PoseTimeLine> poses;  ///< null: the pose above stays
  bool pose_stale = false;

  /// The same with the pose of a moment of the server's monotonic clock.
  LiveView at(std::int64_t now_ns) const;
};

}  // namespace obliq::net
