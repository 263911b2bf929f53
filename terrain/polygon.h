#pragma once
// Polygons in the world's (x, z) plane. Rings are closed implicitly; inside is decided by the even-odd rule,
// so that holes need no special treatment.
#include <cstddef>
#include <glm/vec2.hpp>
#include <vector>

namespace obliq {

using Ring = std::vector<glm::dvec2>;  ///< world (x, z), metres

/// An axis-aligned rectangle in world (x, z), metres. Empty while x1 < x0.
struct Rect {
  double x0_m = 0, z0_m = 0, x1_m = -1, z1_m = -1;

  bool empty() const { return !(x0_m <= x1_m && z0_m <= z1_m); }
  void include(glm::dvec2 p);
  Rect intersection(const Rect& other) const;
};

struct Polygon {
  std::vector<Ring> rings;

  bool contains(glm::dvec2 p) const;
};

/// Rectangle around every vertex.
Rect bounds(const Polygon& polygon);

/// Twice-signed-area's half: positive when the ring runs counter-clockwise on a map (x right, z up).
double signed_area_m2(const Ring& ring);

/// Sorted x of the polygon's edges where they cross the line at z. Between crossings 2n and 2n + 1 the line
/// is inside. An edge owns its lower end and not its upper one, so that vertices count once.
void crossings(const Polygon& polygon, double z_m, std::vector<double>& x_m);

using FloatRing = std::vector<glm::vec2>;   ///< closed implicitly
using FloatRings = std::vector<FloatRing>;  ///< of one polygon, the outer one first

/// How many pairs of edges have a point in common, neighbours at a corner not counted; stops at `most`.
std::size_t count_crossings(const FloatRings& rings, std::size_t most);

}  // namespace obliq
