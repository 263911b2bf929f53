#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "server/radar/targets/target.h"
#include "terrain/world.h"

namespace obliq {

/// Where a target is.
struct TargetPlace {
  glm::dvec3 foot_m{0.0};  ///< in the world
  double heading_rad = 0;  ///< world angle of its nose
};

/// At a time of the poses' clock: straight on by velocity and acceleration, p + v t + a t^2 / 2 in the axes
/// of the place that was given; with a height over the ground always on the scene's own ground, on the datum
/// where none is known. Nothing where it is a quarter of the earth's way from that place or more.
std::optional<TargetPlace> place_target(const World& world, const Target& target, std::int64_t sim_time_ns);

}  // namespace obliq
