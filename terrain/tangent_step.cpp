#include "terrain/tangent_step.h"

namespace obliq {

Geodetic moved(const Geodetic& from, const glm::dvec3& step_m) {
  const WorldFrame frame(from.latitude_rad, from.longitude_rad, 1);
  return frame.geodetic_from_world({frame.world_from_geodetic(from).m + step_m});
}

}  // namespace obliq
