#include "terrain/buildings/building_mesh.h"

namespace obliq {
namespace {

/// Triangles of a roof.
std::uint32_t roof_count(const Buildings& all, const Building& building) {
  if (building.n_parts == 0) {
    const auto n = static_cast<std::uint32_t>(all.outline(building).size());
    return n < 3 ? 0 : n - 2;
  }
  std::uint32_t count = 0;
  for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p)
    count += all.parts[p].n_corners - 2;
  return count;
}

}  // namespace

WallEdge edge_of_wall(const Buildings& all, std::uint32_t of, std::uint32_t face) {
  const Building& building = all.list[of];
  std::uint32_t begin = all.first_corner(of);
  std::uint32_t edge = face - building.first_face - 1;
  std::uint32_t size = building.n_faces - 1;
  if (building.n_rings > 1) {
    const auto size_of = [&](std::uint32_t r) { return static_cast<std::uint32_t>(all.ring(r).size()); };
    std::uint32_t ring = building.first_ring;
    for (; edge >= size_of(ring); ++ring) edge -= size_of(ring);
    begin = all.ring_start[ring];
    size = size_of(ring);
  }
  return {begin + edge, begin + (edge + 1) % size};
}

Triangle triangle_of(const Buildings& all, std::uint32_t face, std::uint32_t number) {
  const std::uint32_t of = all.building_of_face[face];
  const Building& building = all.list[of];
  if (face != building.first_face) {
    const WallEdge edge = edge_of_wall(all, of, face);
    const glm::vec2 p = all.ring_xz_m[edge.from], q = all.ring_xz_m[edge.to];
    return number == 0 ? lower_half(building, p, q) : upper_half(building, p, q);
  }
  const glm::vec2* corner = all.outline(building).data();
  if (building.n_parts > 0) {
    const ConvexPart* part = &all.parts[building.first_part];
    for (; number >= part->n_corners - 2; ++part) number -= part->n_corners - 2;
    corner = &all.part_xz_m[part->first_corner];
  }
  const FanCorners at = fan(number);
  return {over(corner[at.a], building.roof_y_m), over(corner[at.b], building.roof_y_m),
          over(corner[at.c], building.roof_y_m)};
}

std::uint32_t triangle_count(const Buildings& all, const Building& building) {
  return roof_count(all, building) + (all.walls ? 2 * (building.n_faces - 1) : 0);
}

std::uint64_t triangle_count(const Buildings& all) {
  std::uint64_t count = 0;
  for (const Building& building : all.list) count += triangle_count(all, building);
  return count;
}

BuildingMesh mesh_of(const Buildings& all) {
  BuildingMesh mesh;
  const std::uint64_t n_triangles = triangle_count(all);
  mesh.vertices_m.reserve(2 * all.ring_xz_m.size() + all.part_xz_m.size() + 1);
  mesh.triangles.reserve(n_triangles);
  mesh.triangle_face.reserve(n_triangles);
  const auto add = [&](std::uint32_t face, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangle_face.push_back(face);
  };
  // Of each building the roof's corners, then the base's, ring by ring; behind all of them the parts'.
  const auto first_part_vertex = static_cast<std::uint32_t>(2 * all.ring_xz_m.size());
  for (const Building& building : all.list) {
    const std::uint32_t begin = all.ring_start[building.first_ring];
    const std::uint32_t end = all.ring_start[building.first_ring + building.n_rings];
    const std::uint32_t to_base = end - begin;
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const float y_m : {building.roof_y_m, building.base_y_m})
      for (std::uint32_t k = begin; k < end; ++k) mesh.vertices_m.push_back(over(all.ring_xz_m[k], y_m));
    const auto add_fan = [&](std::uint32_t vertex, std::uint32_t n) {
      for (std::uint32_t k = 0; k + 2 < n; ++k) {
        const FanCorners at = fan(k);
        add(building.first_face, vertex + at.a, vertex + at.b, vertex + at.c);
      }
    };
    if (building.n_parts == 0) add_fan(first, all.ring_start[building.first_ring + 1] - begin);
    for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p)
      add_fan(first_part_vertex + all.parts[p].first_corner, all.parts[p].n_corners);
    if (!all.walls) continue;
    for (std::uint32_t wall = 0; wall + 1 < building.n_faces; ++wall) {
      const std::uint32_t face = building.first_face + 1 + wall;
      const WallEdge edge = edge_of_wall(all, face);
      const std::uint32_t p = first + edge.from - begin, q = first + edge.to - begin;
      add(face, p + to_base, p, q);
      add(face, p + to_base, q, q + to_base);
    }
  }
  for (const Building& building : all.list) {
    for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p)
      for (std::uint32_t k = 0; k < all.parts[p].n_corners; ++k)
        mesh.vertices_m.push_back(over(all.part_xz_m[all.parts[p].first_corner + k], building.roof_y_m));
  }
  return mesh;
}

}  // namespace obliq
