#pragma once
// What stands highest before a point that an antenna looks at.
#include <glm/vec3.hpp>

#include "server/scene/scene.h"

namespace obliq {

/// What lies less than this under a surface counts as on it, and what less than this hides is seen.
constexpr double kOnSurface_m = 1e-3;

/// The place of greatest elevation on the vertical profile from the antenna up to the point, the ground under
/// the point included, ground distance and height over the antenna.
struct Obstacle {
  double d_m = 0;   ///< 0: there is nothing
  double h_m = -1;  ///< straight down
  bool building = false;
};

/// Exactly what a march over every cell and roof would have found, for the price of a look at the squares in
/// which something may stand higher than what has been found. Of several at one elevation the nearest.
Obstacle highest_before(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& point_m);

/// Whether ground is not known anywhere on that profile, off the grid included.
bool passes_unknown(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& point_m);

}  // namespace obliq
