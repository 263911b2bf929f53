#pragma once
// Leaked rays found and answered anew. Embree lets a ray through the mesh now and then
// where it meets a vertex or an edge exactly; what the ray meets next proves it.
#include <glm/vec3.hpp>
#include <optional>

#include "server/scene/exact_hit.h"
#include "server/scene/scene.h"

namespace obliq {

/// What a ray meets first, in double precision.
struct RayAnswer {
  std::optional<ExactHit> hit;
  bool repaired = false;    ///< the ray had leaked; the hit is the exact walk's
  bool unanswered = false;  ///< the ray had leaked, and the exact walk finds nothing either
};

/// Refines a rough hit, unless it proves that the ray has leaked: a first hit on an underside or an inner
/// face, on ground under a building, on a building below the ground or inside another one; a ray that ends in
/// nothing although it leaves the grid below its border, or sinks below all ground over known ground. Such a
/// ray is answered by first_hit.
RayAnswer answer_ray(const Scene& scene, const glm::dvec3& origin_m, const glm::dvec3& direction,
                     const RoughHit& rough);

/// Whether a point of the ground lies inside a building: a ray that meets it first has leaked.
bool ground_is_buried(const Scene& scene, const glm::dvec3& point_m);

/// The first surface that the ray meets from its lit side, by walking the ground grid's cells and every
/// building near the ray in double precision. Slow (microseconds a kilometre), sure, and bounded by the grid.
std::optional<ExactHit> first_hit(const Scene& scene, const glm::dvec3& origin_m,
                                  const glm::dvec3& direction);

}  // namespace obliq
