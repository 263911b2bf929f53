#include "server/radar/targets/seen_share.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/line_to_point.h"

namespace obliq {

double seen_share(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& foot_m, double top_m) {
  const Obstacle highest = highest_before(scene, antenna_m, foot_m);
  if (!(highest.d_m > 0)) return 1;
  const double d_m = std::hypot(foot_m.x - antenna_m.x, foot_m.z - antenna_m.z);
  // Height over the foot at which the line over the obstacle passes.
  const double hidden_m = antenna_m.y + highest.h_m / highest.d_m * d_m - foot_m.y;
  if (hidden_m <= kOnSurface_m) return 1;
  return top_m > 0 ? std::clamp((top_m - hidden_m) / top_m, 0.0, 1.0) : 0;
}

}  // namespace obliq
