#pragma once
#include "server/scene/exact_hit.h"

namespace obliq::test {

/// refine_near, and where that has no answer the first ground up to the rough hit, or the same building's
/// nearest face: for tests that have a world and no scene.
inline std::optional<ExactHit> refine_hit(const World& world, const glm::dvec3& origin_m,
                                          const glm::dvec3& direction, const RoughHit& rough) {
  if (auto hit = refine_near(world, origin_m, direction, rough)) return hit;
  const auto rough_m = static_cast<double>(rough.distance_m);
  if (rough.kind == RoughHit::Kind::ground)
    return walk_ground(world, origin_m, direction, 0, rough_m + refinement_reach_m(world, rough_m));
  if (rough.kind == RoughHit::Kind::building)
    return cross_building(world, world.buildings.building_of_face[rough.face], origin_m, direction);
  return std::nullopt;
}

}  // namespace obliq::test
