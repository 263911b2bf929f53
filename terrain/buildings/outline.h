#pragma once
// Makes building outlines valid and cuts them into triangles, by GEOS, and convex parts.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "terrain/buildings/convex_parts.h"
#include "terrain/polygon.h"

namespace obliq {

/// A valid outline with holes in float32 world (x, z), exactly the coordinates that the mesh gets: the outer
/// ring counter-clockwise on a map (x right, z up), holes clockwise, no point twice in a row.
struct Outline {
  std::vector<std::vector<glm::vec2>> rings_m;
  /// Corners of the roof's triangles as indices into all points of all rings in order, clockwise on a map.
  std::vector<glm::uvec3> roof;
  std::vector<PartRing> parts;  ///< none: the outline is convex (terrain/buildings/convex_parts.h)
  double area_m2 = 0;
  glm::dvec2 centre_m{0.0};  ///< of the area
};

enum class OutlineState { good, repaired, zero_area, unusable, too_complex };

struct ShapedOutline {
  OutlineState state = OutlineState::unusable;
  std::vector<Outline> parts;  ///< none unless good or repaired; a repair may make several
  std::string excess;          ///< too_complex: what was found and what is allowed
};

/// Owns one GEOS context; one thread at a time.
class OutlineShaper {
 public:
  OutlineShaper();
  ~OutlineShaper();
  OutlineShaper(const OutlineShaper&) = delete;
  OutlineShaper& operator=(const OutlineShaper&) = delete;

  /// Rounds to float32, repairs self-intersections (GEOS, structure method: overlaps are united, holes kept)
  /// and triangulates. Outlines of less than kLeastArea_m2 have no area. Never throws on any coordinates.
  /// Time grows with the square of the corners, and of the crossings: beyond the limits an outline is too
  /// complex. At the limits it takes about a second.
  ShapedOutline shape(const Polygon& polygon);

  static constexpr std::size_t kMostCorners = 4096;    ///< of all rings together
  static constexpr std::size_t kMostCrossings = 1024;  ///< pairs of edges that cross or touch

  static constexpr double kLeastArea_m2 = 0.01;

 private:
  struct Geos;
  std::unique_ptr<Geos> geos_;
};

/// The excess of a polygon with too many corners; empty: it has not.
std::string excess_corners(std::size_t corners);

}  // namespace obliq
