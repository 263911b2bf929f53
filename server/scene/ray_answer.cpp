#include "server/scene/ray_answer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/scene/tolerances.h"

namespace obliq {
namespace {

/// Distances at which the ray is over the grid; empty when from > to.
struct OverGrid {
  double from_m = 0;
  double to_m = std::numeric_limits<double>::infinity();

  OverGrid(const HeightGrid& grid, const glm::dvec3& origin, const glm::dvec3& direction) {
    cut(origin.x, direction.x, grid.x0_m, grid.x1_m());
    cut(origin.z, direction.z, grid.z0_m, grid.z1_m());
  }
  void cut(double start, double rate, double low, double high) {
    if (rate == 0) {
      if (start < low || start > high) to_m = -1;
      return;
    }
    const double a = (low - start) / rate;
    const double b = (high - start) / rate;
    from_m = std::max(from_m, std::min(a, b));
    to_m = std::min(to_m, std::max(a, b));
  }
};

/// A ray that met nothing: does it end below the ground?
bool ends_below_ground(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  if (!(direction.y < 0)) return false;
  const HeightGrid& grid = scene.world().grid;
  const OverGrid over(grid, origin, direction);
  if (!(over.from_m <= over.to_m)) return false;
  const auto below = [&](double distance) {
    const double x = std::clamp(origin.x + distance * direction.x, grid.x0_m, grid.x1_m());
    const double z = std::clamp(origin.z + distance * direction.z, grid.z0_m, grid.z1_m());
    // False over unknown ground.
    return grid.height_at_m(x, z) > origin.y + distance * direction.y + kLeakDepth_m;
  };
  const double sunk_m = (scene.tiles().lowest_m() - kLeakDepth_m - origin.y) / direction.y;
  if (sunk_m >= over.from_m && sunk_m <= over.to_m && below(sunk_m + 2 * kLeakDepth_m / -direction.y))
    return true;
  return std::isfinite(over.to_m) && below(over.to_m);
}

/// Does a point lie inside a building, but for one that it belongs to?
bool in_building(const Scene& scene, const glm::dvec3& p, std::uint32_t owner) {
  return scene.building_index().any_near(p.x, p.z, [&](std::uint32_t building) {
    return building != owner &&
           inside_building(scene.world().buildings, building, p.x, p.y, p.z, kLeakDepth_m);
  });
}

/// A hit on a lit side: does it lie inside a solid?
bool is_buried(const Scene& scene, const ExactHit& hit) {
  if (hit.face == kNoFace) return ground_is_buried(scene, hit.position_m);
  const World& world = scene.world();
  const glm::dvec3& p = hit.position_m;
  if (p.y < world.grid.height_at_m(p.x, p.z) - kLeakDepth_m) return true;
  return in_building(scene, p + 2 * kLeakDepth_m * hit.normal, world.buildings.building_of_face[hit.face]);
}

}  // namespace

bool ground_is_buried(const Scene& scene, const glm::dvec3& point_m) {
  constexpr std::uint32_t kNobody = 0xffffffffu;
  return in_building(scene, point_m, kNobody);
}

std::optional<ExactHit> first_hit(const Scene& scene, const glm::dvec3& origin_m,
                                  const glm::dvec3& direction) {
  const World& world = scene.world();
  const OverGrid over(world.grid, origin_m, direction);
  if (!(over.from_m <= over.to_m)) return std::nullopt;
  // Straight up or down, the ray is over the grid for ever; nothing lies farther than the lowest ground.
  double end_m = over.to_m;
  if (!std::isfinite(end_m))
    end_m = std::max(0.0, (scene.tiles().lowest_m() - 1 - origin_m.y) / std::min(direction.y, -1e-9));
  std::optional<ExactHit> first = walk_ground(world, origin_m, direction, over.from_m, end_m);
  if (first) end_m = first->slant_range_m;
  if (scene.building_index().empty()) return first;
  std::vector<std::uint32_t> near;
  const auto in_plane = [&](double distance) {
    return glm::dvec2(origin_m.x + distance * direction.x, origin_m.z + distance * direction.z);
  };
  scene.building_index().along(in_plane(over.from_m), in_plane(end_m), near);
  for (const std::uint32_t building : near) {
    const auto found = cross_building(world, building, origin_m, direction);
    if (found && found->slant_range_m < end_m) {
      first = found;
      end_m = found->slant_range_m;
    }
  }
  return first;
}

RayAnswer answer_ray(const Scene& scene, const glm::dvec3& origin_m, const glm::dvec3& direction,
                     const RoughHit& rough) {
  RayAnswer answer;
  if (rough.kind == RoughHit::Kind::none) {
    if (!ends_below_ground(scene, origin_m, direction)) return answer;
  } else {
    answer.hit = refine_near(scene.world(), origin_m, direction, rough);
    if (answer.hit && !is_buried(scene, *answer.hit)) return answer;
  }
  answer.hit = first_hit(scene, origin_m, direction);
  answer.unanswered = !answer.hit;
  // Next to a silhouette the refinement may give up although nothing has leaked.
  answer.repaired =
      answer.hit && !(rough.kind != RoughHit::Kind::none &&
                      std::abs(answer.hit->slant_range_m - static_cast<double>(rough.distance_m)) <=
                          refinement_reach_m(scene.world(), static_cast<double>(rough.distance_m)));
  return answer;
}

}  // namespace obliq
