#include "terrain/buildings/extrude.h"

#include <algorithm>
#include <cmath>

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
  building.n_rings = static_cast<std::uint16_t>(outline.rings_m.size());
  building.first_face = count(buildings.building_of_face.size());
  building.roof_y_m = static_cast<float>(footing.mean_y_m + look.height_m);
  building.base_y_m = static_cast<float>(footing.lowest_y_m - kBaseDepth_m);
  building.material = look.material;
  building.identity = look.identity;
  building.centre_m = outline.centre_m;
  building.walls_y_m = footing.mean_y_m + look.height_m / 2;
  building.n_faces = 1;
  for (const auto& ring : outline.rings_m) {
    building.n_faces += count(ring.size());
    buildings.ring_xz_m.insert(buildings.ring_xz_m.end(), ring.begin(), ring.end());
    buildings.ring_start.push_back(count(buildings.ring_xz_m.size()));
  }
  buildings.building_of_face.insert(buildings.building_of_face.end(), building.n_faces,
                                    count(buildings.list.size()));
  append_parts(buildings, outline, building);
  buildings.list.push_back(building);
}

}  // namespace obliq
