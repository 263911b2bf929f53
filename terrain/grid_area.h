#pragma once
// What part of the world is loaded, and the empty grid over it.
#include <vector>

#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/polygon.h"
#include "terrain/world_spec.h"

namespace obliq {

/// The part of the world that a scene asks for, in world (x, z).
struct WantedArea {
  struct Disc {
    glm::dvec2 centre_m{0.0};
    double radius_m = 0;
  };

  Rect rect;                ///< around everything; empty when the scene asks for whatever there is
  Polygon polygon;          ///< the [terrain] area; no rings when none is given
  std::vector<Disc> discs;  ///< the reaches; none when an area is given

  bool contains(glm::dvec2 p) const;
};

/// Reads [terrain] area or, without one, the reaches. Throws InputError on numbers that are not positions.
WantedArea wanted_area(const WorldSpec& spec, const WorldFrame& frame);

/// World (x, z) of a position on the ellipsoid.
glm::dvec2 world_xz_m(const WorldFrame& frame, const LonLat& position);

/// Rounded to the quantum of grid coordinates, at least one quantum.
double round_to_quantum_m(double length_m);

/// A grid of unknown heights whose nodes are the multiples of cell_m inside rect. Throws InputError when
/// that is more than kMaxNodes or fewer than 2 x 2.
HeightGrid empty_grid(const Rect& rect, double cell_m);

/// About 1 GB of heights, and as many nodes as an Embree scene of a few gigabytes can hold.
constexpr double kMaxNodes = 0x1p28;

/// Makes every node outside the polygon unknown. Does nothing when the polygon has no rings.
void cut_to_polygon(HeightGrid& grid, const Polygon& polygon);

/// Fraction of the wanted area where the grid has ground, sampled at about 2^16 points.
double covered_fraction(const HeightGrid& grid, const WantedArea& wanted);

}  // namespace obliq
