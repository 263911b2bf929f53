#pragma once
#include <glm/vec3.hpp>

#include "server/scene/scene.h"

namespace obliq {

/// The share, 0 to 1, of the plumb line from a target's foot up to its top that stands over all ground and
/// roofs between. Of a target without height: whether its foot does.
double seen_share(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& foot_m, double top_m);

}  // namespace obliq
