#pragma once
// Double-precision re-intersection of what Embree reports (PAPER.md, eq. 13): the range that reaches a bin
// never comes from Embree's float distance.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "server/scene/embree_tracer.h"
#include "terrain/world.h"

namespace obliq {

/// A first hit in double precision, world frame, on the side of the surface that faces the antenna.
struct ExactHit {
  double slant_range_m = 0;
  double cos_incidence = 0;  ///< of the triangle's geometric normal, 0..1
  glm::dvec3 position_m{0.0};
  glm::dvec3 normal{0.0};        ///< unit, towards the antenna
  std::uint32_t face = kNoFace;  ///< building face index; kNoFace on ground
  std::uint8_t material = 0;
  float raster_gamma = 1;  ///< World::raster_gamma of the ground
};

/// Re-intersects a rough hit. origin and unit direction as the double ray; nothing when the rough hit is a
/// leak: an underside, an inner face, or no triangle near it that the double ray meets. ray_answer.h then
/// knows what to do.
std::optional<ExactHit> refine_near(const World& world, const glm::dvec3& origin_m,
                                    const glm::dvec3& direction, const RoughHit& rough);

/// How far along the ray a refined hit may lie from the rough one.
double refinement_reach_m(const World& world, double rough_m);

/// The nearest outer face of a building that the ray meets.
std::optional<ExactHit> cross_building(const World& world, std::uint32_t building, const glm::dvec3& origin_m,
                                       const glm::dvec3& direction);

/// The first triangle of the ground that the ray meets from above with distance in [from_m, to_m], found by
/// walking the grid's cells in double precision. Slow and sure.
std::optional<ExactHit> walk_ground(const World& world, const glm::dvec3& origin_m,
                                    const glm::dvec3& direction, double from_m, double to_m);

}  // namespace obliq
