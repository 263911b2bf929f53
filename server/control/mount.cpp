#include "server/control/mount.h"

#include <cmath>
#include <glm/vec3.hpp>

#include "terrain/base/units.h"
#include "terrain/tangent_step.h"

namespace obliq {
namespace {

/// Of the mount from the platform's reference point: x east, y up, z north. Turned by roll about the
/// platform's long axis, then by pitch, then by heading (the order of aircraft's angles, ISO 1151-1).
glm::dvec3 lever_arm_m(const PoseSettings& platform, const Mount& mount) {
  const auto turned = [](double a, double b, double angle_deg) {
    const double angle_rad = angle_deg * kDegree_rad;
    return a * std::cos(angle_rad) + b * std::sin(angle_rad);
  };
  const double right = turned(mount.right_m, mount.up_m, platform.roll_deg);
  const double up_level = turned(mount.up_m, -mount.right_m, platform.roll_deg);
  const double ahead = turned(mount.forward_m, -up_level, platform.pitch_deg);
  const double up = turned(up_level, mount.forward_m, platform.pitch_deg);
  return {turned(right, ahead, platform.heading_deg), up, turned(ahead, -right, platform.heading_deg)};
}

}  // namespace

PoseSettings riding(const PoseSettings& platform, const Mount& mount, const PoseSettings& aim) {
  PoseSettings pose = platform;
  const double centre_deg = std::remainder(aim.bearing_deg - aim.heading_deg, 360.0);
  pose.bearing_deg = std::remainder(platform.heading_deg + centre_deg, 360.0);
  pose.tilt_deg = aim.tilt_deg;
  pose.tilt_auto = aim.tilt_auto;
  if (mount.forward_m == 0 && mount.right_m == 0 && mount.up_m == 0) return pose;

  const glm::dvec3 arm_m = lever_arm_m(platform, mount);
  const bool over_ground = platform.height_reference == HeightReference::ground;
  const Geodetic here{platform.latitude_deg * kDegree_rad, platform.longitude_deg * kDegree_rad,
                      over_ground ? 0 : platform.height_m};
  const Geodetic there = moved(here, arm_m);
  pose.latitude_deg = there.latitude_rad / kDegree_rad;
  pose.longitude_deg = there.longitude_rad / kDegree_rad;
  pose.height_m = over_ground ? platform.height_m + arm_m.y : there.height_m;
  return pose;
}

PoseSettings riding_at_start(const PlatformConfig& platform, const Mount& mount, const PoseSettings& aim) {
  PoseSettings ahead = aim;
  ahead.heading_deg = 0;
  ahead.bearing_deg = mount.look_deg;
  return riding(platform.pose, mount, ahead);
}

}  // namespace obliq
