#include "server/scene/exact_hit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "server/scene/ground_triangle.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq {
namespace {

GroundTriangle<double> triangle_of(const HeightGrid& grid, int i, int j, bool upper) {
  return {grid,
          static_cast<double>(i),
          static_cast<double>(j),
          upper,
          grid.node_y_m(i, j),
          grid.node_y_m(i + 1, j),
          grid.node_y_m(i, j + 1),
          grid.node_y_m(i + 1, j + 1)};
}
double descent(const GroundTriangle<double>& triangle, const glm::dvec3& direction) {
  return triangle.descent(direction.x, direction.y, direction.z);
}
/// Where a ray that descends to the triangle's plane meets it.
double distance_to(const GroundTriangle<double>& triangle, const glm::dvec3& origin, double descent) {
  return -triangle.height_above(origin.x, origin.y, origin.z) / descent;
}

ExactHit ground_hit(const World& world, const GroundTriangle<double>& triangle, int i, int j,
                    const glm::dvec3& origin, const glm::dvec3& direction, double distance) {
  ExactHit hit;
  hit.slant_range_m = distance;
  hit.position_m = origin + distance * direction;
  const double steepness = std::sqrt(triangle.steepness2());
  hit.normal = glm::dvec3(-triangle.slope_x, 1, -triangle.slope_z) / steepness;
  hit.cos_incidence = std::min(1.0, std::abs(descent(triangle, direction)) / steepness);
  hit.material = world.material_of_cell(i, j);
  hit.raster_gamma = world.raster_gamma_of_cell(i, j);
  return hit;
}

/// Where the ray crosses the triangle from above, if it does so inside it (with edge slack).
std::optional<double> cross_ground_triangle(const GroundTriangle<double>& triangle, const glm::dvec3& origin,
                                            const glm::dvec3& direction) {
  const double descends = descent(triangle, direction);
  if (!(descends < 0)) return std::nullopt;
  const double distance = distance_to(triangle, origin, descends);
  const bool inside = triangle.holds(origin.x + distance * direction.x, origin.z + distance * direction.z);
  if (!inside || !(distance > 0)) return std::nullopt;
  return distance;
}

std::optional<ExactHit> refine_ground(const World& world, const glm::dvec3& origin,
                                      const glm::dvec3& direction, double rough_m) {
  const HeightGrid& grid = world.grid;
  // Newton steps from triangle to triangle: intersect the plane of the triangle under the point, move there.
  double distance = rough_m;
  for (int step = 0; step < 4; ++step) {
    const double u = (origin.x + distance * direction.x - grid.x0_m) / grid.cell_m;
    const double v = (origin.z + distance * direction.z - grid.z0_m) / grid.cell_m;
    if (!(u > -1 && v > -1 && u < grid.nx && v < grid.nz)) break;
    const int i = std::clamp(static_cast<int>(u), 0, grid.nx - 2);
    const int j = std::clamp(static_cast<int>(v), 0, grid.nz - 2);
    if (!grid.cell_known(i, j)) break;
    const bool upper = (u - i) + (v - j) > 1;
    const GroundTriangle<double> triangle = triangle_of(grid, i, j, upper);
    const double descends = descent(triangle, direction);
    if (!(descends < 0)) {
      if (step == 0) return std::nullopt;  // an underside
      break;
    }
    if (const auto found = cross_ground_triangle(triangle, origin, direction))
      return ground_hit(world, triangle, i, j, origin, direction, *found);
    distance = distance_to(triangle, origin, descends);
    if (!(std::abs(distance - rough_m) < 4 * grid.cell_m)) break;
  }
  // Near a silhouette the steps may wander: walk the neighbourhood of the rough hit instead.
  const double reach = refinement_reach_m(world, rough_m);
  return walk_ground(world, origin, direction, std::max(0.0, rough_m - reach), rough_m + reach);
}

/// Where the ray crosses a building triangle from outside; nothing for inner faces and misses.
std::optional<double> cross_building_triangle(const Triangle& triangle, const glm::dvec3& origin,
                                              const glm::dvec3& direction, glm::dvec3& outward) {
  const glm::dvec3 a = glm::dvec3(triangle[0]) - origin;
  const glm::dvec3 b = glm::dvec3(triangle[1]) - origin;
  const glm::dvec3 c = glm::dvec3(triangle[2]) - origin;
  // Left-handed axes: the outward normal is (b - a) x (c - a) for triangles that run clockwise seen from
  // outside on right-handed paper; building_mesh.h states the rule.
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::length(normal);
  if (!(area2 > 0)) return std::nullopt;
  outward = normal / area2;
  const double approach = glm::dot(outward, direction);
  if (!(approach < 0)) return std::nullopt;
  const double distance = glm::dot(outward, a) / approach;
  if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
  const glm::dvec3 p = distance * direction;
  const double slack = -kFaceEdge * area2;
  const bool inside = glm::dot(glm::cross(b - a, p - a), outward) >= slack &&
                      glm::dot(glm::cross(c - b, p - b), outward) >= slack &&
                      glm::dot(glm::cross(a - c, p - c), outward) >= slack;
  if (!inside) return std::nullopt;
  return distance;
}

ExactHit building_hit(const Buildings& buildings, std::uint32_t face, const glm::dvec3& origin,
                      const glm::dvec3& direction, const glm::dvec3& outward, double distance) {
  ExactHit hit;
  hit.slant_range_m = distance;
  hit.position_m = origin + distance * direction;
  hit.normal = outward;
  hit.cos_incidence = std::min(1.0, std::abs(glm::dot(outward, direction)));
  hit.face = face;
  hit.material = buildings.list[buildings.building_of_face[face]].material;
  return hit;
}

std::optional<ExactHit> refine_building(const World& world, const glm::dvec3& origin,
                                        const glm::dvec3& direction, const RoughHit& rough) {
  const Buildings& buildings = world.buildings;
  glm::dvec3 outward{0.0};
  if (const auto distance = cross_building_triangle(triangle_of(buildings, rough.face, rough.triangle),
                                                    origin, direction, outward))
    return building_hit(buildings, rough.face, origin, direction, outward, *distance);
  // The double ray misses the reported triangle: it may meet the face beside it. A farther one would mean
  // that the ray has leaked into the building, and met an inner side.
  const auto rough_m = static_cast<double>(rough.distance_m);
  const auto near = cross_building(world, buildings.building_of_face[rough.face], origin, direction);
  if (!near || !(std::abs(near->slant_range_m - rough_m) <= refinement_reach_m(world, rough_m)))
    return std::nullopt;
  return near;
}

}  // namespace

std::optional<ExactHit> walk_ground(const World& world, const glm::dvec3& origin_m,
                                    const glm::dvec3& direction, double from_m, double to_m) {
  const HeightGrid& grid = world.grid;
  const auto column_at = [&](double distance) {
    return static_cast<int>(std::floor((origin_m.x + distance * direction.x - grid.x0_m) / grid.cell_m));
  };
  const auto row_at = [&](double distance) {
    return static_cast<int>(std::floor((origin_m.z + distance * direction.z - grid.z0_m) / grid.cell_m));
  };
  double distance = from_m;
  int i = column_at(from_m);
  int j = row_at(from_m);
  const int step_i = direction.x > 0 ? 1 : -1;
  const int step_j = direction.z > 0 ? 1 : -1;
  while (distance <= to_m) {
    if (grid.cell_known(i, j)) {
      std::optional<double> first;
      bool first_upper = false;
      for (const bool upper : {false, true}) {
        const auto found = cross_ground_triangle(triangle_of(grid, i, j, upper), origin_m, direction);
        if (found && *found >= from_m && *found <= to_m && (!first || *found < *first)) {
          first = found;
          first_upper = upper;
        }
      }
      if (first)
        return ground_hit(world, triangle_of(grid, i, j, first_upper), i, j, origin_m, direction, *first);
    }
    // On to the cell behind the nearer of the next two grid lines.
    const double edge_x = grid.node_x_m(step_i > 0 ? i + 1 : i);
    const double edge_z = grid.node_z_m(step_j > 0 ? j + 1 : j);
    const double to_x = direction.x != 0 ? (edge_x - origin_m.x) / direction.x : HUGE_VAL;
    const double to_z = direction.z != 0 ? (edge_z - origin_m.z) / direction.z : HUGE_VAL;
    if (!(std::isfinite(to_x) || std::isfinite(to_z))) break;
    if (to_x < to_z) {
      i += step_i;
      distance = to_x;
    } else {
      j += step_j;
      distance = to_z;
    }
  }
  return std::nullopt;
}

std::optional<ExactHit> cross_building(const World& world, std::uint32_t building, const glm::dvec3& origin_m,
                                       const glm::dvec3& direction) {
  const Buildings& all = world.buildings;
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t nearest_face = 0;
  glm::dvec3 nearest_outward{0.0};
  glm::dvec3 outward{0.0};
  for_each_triangle(all, all.list[building], [&](std::uint32_t face, const Triangle& triangle) {
    const auto found = cross_building_triangle(triangle, origin_m, direction, outward);
    if (found && *found < nearest) {
      nearest = *found;
      nearest_outward = outward;
      nearest_face = face;
    }
  });
  if (!std::isfinite(nearest)) return std::nullopt;
  return building_hit(all, nearest_face, origin_m, direction, nearest_outward, nearest);
}

double refinement_reach_m(const World& world, double rough_m) {
  return 2 * world.grid.cell_m + 1e-4 * rough_m;
}

std::optional<ExactHit> refine_near(const World& world, const glm::dvec3& origin_m,
                                    const glm::dvec3& direction, const RoughHit& rough) {
  switch (rough.kind) {
    case RoughHit::Kind::ground:
      return refine_ground(world, origin_m, direction, static_cast<double>(rough.distance_m));
    case RoughHit::Kind::building:
      return refine_building(world, origin_m, direction, rough);
    case RoughHit::Kind::none:
      break;
  }
  return std::nullopt;
}

}  // namespace obliq
