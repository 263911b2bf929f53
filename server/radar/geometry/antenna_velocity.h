#pragma once
#include "server/radar/geometry/pose.h"
#include "terrain/world.h"

namespace obliq {

/// Of the antenna, in the world's axes, m/s: 0 where the pose has no velocity.
glm::dvec3 antenna_velocity_m_s(const World& world, const Pose& pose);

}  // namespace obliq
