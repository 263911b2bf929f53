#include "terrain/buildings/extrude.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/hash.h"

namespace obliq {
namespace {

std::uint32_t count(std::size_t n) { return static_cast<std::uint32_t>(n); }

double lowest_node_m(const HeightGrid& grid, const Rect& rect) {
  const auto cell = [&](double at_m, double from_m, int n) {
    return std::clamp(static_cast<int>(std::floor((at_m - from_m) / grid.cell_m)), 0, n - 2);
  };
  const int i1 = cell(rect.x1_m, grid.x0_m, grid.nx) + 1;
  const int j1 = cell(rect.z1_m, grid.z0_m, grid.nz) + 1;
  double lowest = HUGE_VAL;
  for (int j = cell(rect.z0_m, grid.z0_m, grid.nz); j <= j1; ++j) {
    for (int i = cell(rect.x0_m, grid.x0_m, grid.nx); i <= i1; ++i) {
      if (grid.node_known(i, j)) lowest = std::min(lowest, grid.node_y_m(i, j));
    }
  }
  return lowest;
}

/// Roof corners first, base corners n further on.
void append_vertices(Buildings& buildings, const Outline& outline, const Building& building) {
  for (float y_m : {building.roof_y_m, building.base_y_m}) {
    for (const auto& ring : outline.rings_m) {
      for (glm::vec2 p : ring) buildings.vertices_m.emplace_back(p.x, y_m, p.y);
    }
  }
}

void append_roof(Buildings& buildings, const Outline& outline, const BuildingFace& face,
                 std::uint32_t first) {
  const std::uint32_t index = count(buildings.faces.size());
  buildings.faces.push_back(face);
  for (glm::uvec3 t : outline.roof) {
    buildings.triangles.push_back(t + glm::uvec3(first));
    buildings.triangle_face.push_back(index);
  }
}

/// The wall over the edge from corner a to corner b, interior on the left as seen on a map.
void append_wall(Buildings& buildings, const BuildingFace& face, std::uint32_t roof_a, std::uint32_t roof_b,
                 std::uint32_t n) {
  const std::uint32_t index = count(buildings.faces.size());
  buildings.faces.push_back(face);
  buildings.triangles.emplace_back(roof_a + n, roof_a, roof_b);
  buildings.triangles.emplace_back(roof_a + n, roof_b, roof_b + n);
  buildings.triangle_face.insert(buildings.triangle_face.end(), {index, index});
}

void append_parts(Buildings& buildings, const Outline& outline, Building& building) {
  building.first_part = count(buildings.parts.size());
  building.n_parts = count(outline.parts.size());
  FloatRing corners;
  if (building.n_parts > 0)
    for (const FloatRing& ring : outline.rings_m) corners.insert(corners.end(), ring.begin(), ring.end());
  for (const PartRing& part : outline.parts) {
    buildings.parts.push_back({count(buildings.part_xz_m.size()), count(part.size())});
    for (const PartEdge& edge : part) {
      buildings.part_xz_m.push_back(corners[edge.corner]);
      // Walls have their faces behind the roof's, in ring order.
      buildings.part_wall.push_back(edge.wall == kNoFace ? kNoFace : building.first_face + 1 + edge.wall);
    }
  }
}

}  // namespace

void Buildings::trim() {
  list.shrink_to_fit();
  faces.shrink_to_fit();
  ring_start.shrink_to_fit();
  ring_xz_m.shrink_to_fit();
  parts.shrink_to_fit();
  part_xz_m.shrink_to_fit();
  part_wall.shrink_to_fit();
  triangles.shrink_to_fit();
  triangle_face.shrink_to_fit();
  std::vector<glm::vec3> with_room;
  with_room.reserve(vertices_m.size() + 1);
  with_room = vertices_m;
  vertices_m = std::move(with_room);
}

Footing footing_of(const HeightGrid& grid, const Outline& outline) {
  Footing footing;
  Rect rect;
  double sum_m = 0;
  bool known = true;
  for (glm::vec2 corner : outline.rings_m[0]) {
    const glm::dvec2 p(corner);
    rect.include(p);
    if (p.x < grid.x0_m || p.x > grid.x1_m() || p.y < grid.z0_m || p.y > grid.z1_m()) return footing;
    const double y_m = grid.height_at_m(p.x, p.y);
    if (std::isnan(y_m)) known = false;
    sum_m += y_m;
  }
  footing.state = known ? Footing::State::good : Footing::State::no_ground;
  if (!known) return footing;
  footing.mean_y_m = sum_m / static_cast<double>(outline.rings_m[0].size());
  footing.lowest_y_m = lowest_node_m(grid, rect);
  return footing;
}

void append_prism(Buildings& buildings, const Outline& outline, const Footing& footing,
                  const PrismLook& look) {
  Building building;
  building.first_ring = count(buildings.ring_start.size() - 1);
  building.n_rings = count(outline.rings_m.size());
  building.first_face = count(buildings.faces.size());
  building.first_triangle = count(buildings.triangles.size());
  building.roof_y_m = static_cast<float>(footing.mean_y_m + look.height_m);
  building.base_y_m = static_cast<float>(footing.lowest_y_m - kBaseDepth_m);
  building.material = look.material;

  const std::uint32_t first_vertex = count(buildings.vertices_m.size());
  append_vertices(buildings, outline, building);
  const std::uint32_t n = (count(buildings.vertices_m.size()) - first_vertex) / 2;

  BuildingFace face;
  face.building = count(buildings.list.size());
  face.centre_m = glm::dvec3(outline.centre_m.x, static_cast<double>(building.roof_y_m), outline.centre_m.y);
  face.identity = mix64(look.identity);
  append_roof(buildings, outline, face, first_vertex);

  face.wall = true;
  std::uint32_t corner = first_vertex;
  for (const auto& ring : outline.rings_m) {
    const std::uint32_t size = count(ring.size());
    for (std::uint32_t k = 0; k < size; ++k) {
      const std::uint32_t next = (k + 1) % size;
      const glm::dvec2 middle = (glm::dvec2(ring[k]) + glm::dvec2(ring[next])) / 2.0;
      // Half way up what stands out of the ground.
      face.centre_m = glm::dvec3(middle.x, footing.mean_y_m + look.height_m / 2, middle.y);
      face.identity = mix64(look.identity + 1 + corner + k - first_vertex);
      append_wall(buildings, face, corner + k, corner + next, n);
    }
    corner += size;
    buildings.ring_xz_m.insert(buildings.ring_xz_m.end(), ring.begin(), ring.end());
    buildings.ring_start.push_back(count(buildings.ring_xz_m.size()));
  }
  append_parts(buildings, outline, building);
  building.n_faces = count(buildings.faces.size()) - building.first_face;
  building.n_triangles = count(buildings.triangles.size()) - building.first_triangle;
  buildings.list.push_back(building);
}

}  // namespace obliq
