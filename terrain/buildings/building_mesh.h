#pragma once
// The triangles of buildings. Computed from the outlines when needed: the cross product of
// components, (b - a) x (c - a), points out of the solid; seen from outside the corners run clockwise in
// these left-handed axes. There is no bottom; the base is underground.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "terrain/buildings/buildings.h"

namespace obliq {

using Triangle = std::array<glm::vec3, 3>;  ///< world frame

/// The corners of a wall, into Buildings::ring_xz_m.
struct WallEdge {
  std::uint32_t from;
  std::uint32_t to;
};

/// `face`: a wall of a building. Walls stand in ring order behind the roof.
WallEdge edge_of_wall(const Buildings& all, std::uint32_t building, std::uint32_t face);
inline WallEdge edge_of_wall(const Buildings& all, std::uint32_t face) {
  return edge_of_wall(all, all.building_of_face[face], face);
}

/// Triangle `number` of a face. A wall has two; a roof as many as make up its convex parts, each a fan.
Triangle triangle_of(const Buildings& all, std::uint32_t face, std::uint32_t number);

/// Of all faces of a building.
std::uint32_t triangle_count(const Buildings& all, const Building& building);
std::uint64_t triangle_count(const Buildings& all);

/// Corners of triangle `number` of the fan over n corners of a part, counter-clockwise like it.
struct FanCorners {
  std::uint32_t a, b, c;
};
constexpr FanCorners fan(std::uint32_t number) { return {0, number + 2, number + 1}; }

inline glm::vec3 over(glm::vec2 xz_m, float y_m) { return {xz_m.x, y_m, xz_m.y}; }

/// The two triangles of a wall over the edge from p to q, interior on the left as seen on a map.
inline Triangle lower_half(const Building& b, glm::vec2 p, glm::vec2 q) {
  return {over(p, b.base_y_m), over(p, b.roof_y_m), over(q, b.roof_y_m)};
}
inline Triangle upper_half(const Building& b, glm::vec2 p, glm::vec2 q) {
  return {over(p, b.base_y_m), over(q, b.roof_y_m), over(q, b.base_y_m)};
}

/// Calls use(face, triangle) for each triangle of a building, face by face, roof first.
template <typename Use>
void for_each_triangle(const Buildings& all, const Building& building, Use&& use) {
  const auto fan_over = [&](const glm::vec2* corner, std::uint32_t n) {
    for (std::uint32_t k = 0; k + 2 < n; ++k) {
      const FanCorners at = fan(k);
      use(building.first_face,
          Triangle{over(corner[at.a], building.roof_y_m), over(corner[at.b], building.roof_y_m),
                   over(corner[at.c], building.roof_y_m)});
    }
  };
  const std::span<const glm::vec2> outline = all.outline(building);
  if (building.n_parts == 0) fan_over(outline.data(), static_cast<std::uint32_t>(outline.size()));
  for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p)
    fan_over(&all.part_xz_m[all.parts[p].first_corner], all.parts[p].n_corners);
  if (!all.walls) return;
  std::uint32_t face = building.first_face;
  for (std::uint32_t r = building.first_ring; r < building.first_ring + building.n_rings; ++r) {
    const std::span<const glm::vec2> ring = all.ring(r);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const glm::vec2 p = ring[k], q = ring[k + 1 < ring.size() ? k + 1 : 0];
      ++face;
      use(face, lower_half(building, p, q));
      use(face, upper_half(building, p, q));
    }
  }
}

/// All triangles as Embree wants them, with the corners that neighbours share but for those
/// between a roof of several parts and its walls, which are there twice, with the same bits.
struct BuildingMesh {
  std::vector<glm::vec3> vertices_m;  ///< world frame; has room for one more, as Embree reads 16 bytes
  std::vector<glm::uvec3> triangles;  ///< vertex indices
  std::vector<std::uint32_t>
      triangle_face;  ///< face index of each triangle; those of a face follow each other
};
BuildingMesh mesh_of(const Buildings& buildings);

}  // namespace obliq
