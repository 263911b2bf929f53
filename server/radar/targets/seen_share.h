#pragma once
#include <cstdint>
#include <glm/vec3.hpp>

#include "server/scene/scene.h"

namespace obliq {

/// What of a target is seen.
struct SeenShare {
  double share = 1;          ///< 0 to 1
  bool by_building = false;  ///< what hides the rest
};

/// Of the vertical line from a target's foot to its top, as much as stands over what is highest before it;
/// ground, roofs, curvature and refraction are those of the frames.
SeenShare seen_share(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& foot_m, double top_m);

/// What hides a target, or part of it: the numbers of wire::HiddenBy (server/output/describe_targets.cpp).
enum class HiddenBy : std::uint8_t { nothing = 0, ground = 1, building = 2, horizon = 3, unknown_ground = 4 };

/// "ground", "unknown_ground"; "nothing" also of a number that is none of these.
const char* name_of(HiddenBy hidden);

/// Of a target that is seen so. Horizon: the datum's own surface hides all of it. Unknown ground hides
/// nothing, but what is there may.
HiddenBy hidden_by(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& foot_m, double top_m,
                   const SeenShare& seen);

}  // namespace obliq
