#pragma once
#include "server/radar/sweep_plane.h"
#include "server/scene/scene.h"

namespace obliq {

/// The highest elevation that the ground has along one vertical plane up to to_m: exactly what a march from
/// the nadir would have found, for the price of a look at each tile's highest node.
PlaneHorizon ground_horizon(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing, double to_m);

}  // namespace obliq
