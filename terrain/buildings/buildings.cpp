#include "terrain/buildings/buildings.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/hash.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq {
namespace {

double reach_of(glm::vec2 corner, glm::dvec2 centre) {
  return std::max(std::abs(static_cast<double>(corner.x) - centre.x),
                  std::abs(static_cast<double>(corner.y) - centre.y));
}

}  // namespace

BuildingFace Buildings::face(std::uint32_t building, std::uint32_t index) const {
  const Building& of = list[building];
  BuildingFace face;
  face.identity = mix64(of.identity + (index - of.first_face));
  face.wall = index != of.first_face;
  if (face.wall) {
    const WallEdge edge = edge_of_wall(*this, building, index);
    const glm::dvec2 middle = (glm::dvec2(ring_xz_m[edge.from]) + glm::dvec2(ring_xz_m[edge.to])) / 2.0;
    face.centre_m = glm::dvec3(middle.x, of.walls_y_m, middle.y);
    face.reach_m =
        std::max(reach_of(ring_xz_m[edge.from], middle), static_cast<double>(of.roof_y_m) - face.centre_m.y);
  } else {
    face.centre_m = glm::dvec3(of.centre_m.x, static_cast<double>(of.roof_y_m), of.centre_m.y);
    const std::uint32_t first = first_corner(building);
    const std::uint32_t n = of.n_rings == 1 ? of.n_faces - 1 : static_cast<std::uint32_t>(outline(of).size());
    for (std::uint32_t k = first; k < first + n; ++k)
      face.reach_m = std::max(face.reach_m, reach_of(ring_xz_m[k], of.centre_m));
  }
  return face;
}

void Buildings::trim() {
  list.shrink_to_fit();
  building_of_face.shrink_to_fit();
  ring_start.shrink_to_fit();
  ring_xz_m.shrink_to_fit();
  parts.shrink_to_fit();
  part_xz_m.shrink_to_fit();
  part_wall.shrink_to_fit();
}

}  // namespace obliq
