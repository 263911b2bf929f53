#pragma once
// Radars that ride on a platform: where each stands, and where it looks, from the platform's own pose.
#include <string>

#include "server/control/gimbal.h"
#include "server/radar/settings.h"

namespace obliq {

/// Where an antenna is fixed, from the platform's reference point, in its own axes.
struct Mount {
  double forward_m = 0;
  double right_m = 0;
  double up_m = 0;
  double look_deg = 0;  ///< of the sector's centre at the start, clockwise from the nose
  GimbalLimits gimbal{};
};

/// What radars ride on, as it is configured.
struct PlatformConfig {
  std::string name;
  PoseSettings pose;  ///< of its reference point; where antennas look is theirs
};

/// The pose of a radar on a platform that has this one. `aim` has where its antenna looks: its bearing
/// counts from its own heading, and is taken along with the platform's. A velocity is the platform's: what
/// turning adds at the end of a lever arm is left out.
PoseSettings riding(const PoseSettings& platform, const Mount& mount, const PoseSettings& aim);

/// The same with the sector's centre where the mount looks.
PoseSettings riding_at_start(const PlatformConfig& platform, const Mount& mount, const PoseSettings& aim);

}  // namespace obliq
