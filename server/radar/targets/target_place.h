#pragma once
#include <glm/vec3.hpp>
#include <optional>

#include "server/radar/targets/target.h"
#include "terrain/world.h"

namespace obliq {

/// Where a target is.
struct TargetPlace {
  glm::dvec3 foot_m{0.0};  ///< in the world
  double heading_rad = 0;  ///< world angle of its nose
  double height_m = 0;     ///< of its foot, above the datum
};

/// So long after its place was given (target_motion.h); with a height over the ground always on the scene's
/// own ground, on the datum where none is known.
std::optional<TargetPlace> place_target(const World& world, const Target& target, double age_s);

}  // namespace obliq
