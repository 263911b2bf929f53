#pragma once
// Where an antenna can look from its mount, and where it stands when more is asked of it.
#include <string>

#include "server/radar/settings.h"

namespace obliq {

struct Mount;

/// Angles that a gimbal reaches, about the platform's own axes: azimuth clockwise from where its mount looks,
/// elevation above the platform's level. By default no limit.
struct GimbalLimits {
  double azimuth_min_deg = -180;
  double azimuth_max_deg = 180;
  double elevation_min_deg = -90;
  double elevation_max_deg = 90;

  bool operator==(const GimbalLimits&) const = default;
};

/// Turns the sector's centre, and tilts the boresight, by as little as brings both edges of the sector and
/// its centre within the gimbal's limits; in the middle of them where the sector needs more than there is. A
/// stabilised antenna needs angles of its gimbal that roll and pitch change. An automatic tilt is not held.
PoseSettings held_by(const Mount& mount, const RadarSettings& settings, const PoseSettings& asked);

/// The limits that it stands at, in words; empty: it looks as asked. Of a scan with bars the first bar that
/// is not reached.
std::string limit_met(const Mount& mount, const RadarSettings& settings, const PoseSettings& asked);

}  // namespace obliq
