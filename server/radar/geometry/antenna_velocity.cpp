#include "server/radar/geometry/antenna_velocity.h"

#include "terrain/tangent_step.h"

namespace obliq {

glm::dvec3 antenna_velocity_m_s(const World& world, const Pose& pose) {
  // By where it is a hundredth of a second later, over the ground.
  constexpr double kMoment_s = 0.01;
  const PoseSettings& at = pose.settings;
  const glm::dvec3 flown_m =
      kMoment_s * glm::dvec3(at.velocity_east_m_s.value_or(0), at.velocity_up_m_s.value_or(0),
                             at.velocity_north_m_s.value_or(0));
  if (flown_m == glm::dvec3(0.0)) return flown_m;
  const Geodetic from = world.frame.geodetic_from_world({pose.antenna.m});
  return (world.frame.world_from_geodetic(moved(from, flown_m)).m - world.frame.world_from_geodetic(from).m) /
         kMoment_s;
}

}  // namespace obliq
