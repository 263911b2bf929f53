#include "server/radar/targets/seen_share.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/line_to_point.h"

namespace obliq {
namespace {

/// Whether the straight line to a point dips below the datum on its way.
bool is_below_horizon(const WorldFrame& frame, const glm::dvec3& antenna_m, const glm::dvec3& point_m) {
  constexpr int kSteps = 256;
  for (int k = 1; k < kSteps; ++k) {
    const glm::dvec3 at_m = antenna_m + (point_m - antenna_m) * (static_cast<double>(k) / kSteps);
    if (at_m.y < frame.datum_y_m(at_m.x, at_m.z)) return true;
  }
  return false;
}

}  // namespace

SeenShare seen_share(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& foot_m,
                     double top_m) {
  const Obstacle highest = highest_before(scene, antenna_m, foot_m);
  if (!(highest.d_m > 0)) return {1, false};
  const double d_m = std::hypot(foot_m.x - antenna_m.x, foot_m.z - antenna_m.z);
  // Height over the foot at which the line over the obstacle passes.
  const double hidden_m = antenna_m.y + highest.h_m / highest.d_m * d_m - foot_m.y;
  if (hidden_m <= kOnSurface_m) return {1, false};
  return {top_m > 0 ? std::clamp((top_m - hidden_m) / top_m, 0.0, 1.0) : 0, highest.building};
}

const char* name_of(HiddenBy hidden) {
  switch (hidden) {
    case HiddenBy::ground:
      return "ground";
    case HiddenBy::building:
      return "building";
    case HiddenBy::horizon:
      return "horizon";
    case HiddenBy::unknown_ground:
      return "unknown_ground";
    case HiddenBy::nothing:
      break;
  }
  return "nothing";
}

HiddenBy hidden_by(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& foot_m, double top_m,
                   const SeenShare& seen) {
  const glm::dvec3 head_m = foot_m + glm::dvec3(0, top_m, 0);
  if (seen.share < 1) {
    if (seen.share <= 0 && is_below_horizon(scene.world().frame, antenna_m, head_m)) return HiddenBy::horizon;
    return seen.by_building ? HiddenBy::building : HiddenBy::ground;
  }
  return passes_unknown(scene, antenna_m, foot_m) ? HiddenBy::unknown_ground : HiddenBy::nothing;
}

}  // namespace obliq
