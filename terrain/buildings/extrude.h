#pragma once
#include <cstdint>

#include "terrain/buildings/buildings.h"
#include "terrain/buildings/outline.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Ground under an outline.
struct Footing {
  enum class State { good, off_grid, no_ground };
  State state = State::off_grid;
  double mean_y_m = 0;    ///< over the outer ring's corners
  double lowest_y_m = 0;  ///< no ground under the outline is lower
};

/// Needs known ground under every corner of the outer ring. lowest_y_m is the lowest node of all cells that
/// the outline's bounding rectangle touches: the surface is made of triangles between nodes, so no ground
/// inside is lower, edges and diagonals included.
Footing footing_of(const HeightGrid& grid, const Outline& outline);

/// What a prism is besides its outline and its ground.
struct PrismLook {
  double height_m = 0;
  std::uint8_t material = 1;
  std::uint64_t identity = 0;
};

/// How far the base reaches below the lowest ground, so that none floats whatever the rounding.
constexpr double kBaseDepth_m = 0.5;

/// Appends one prism: a flat roof at mean_y_m + height (a house stands level on sloping ground), a wall for
/// every edge of every ring, no bottom since the base is underground.
void append_prism(Buildings& buildings, const Outline& outline, const Footing& footing,
                  const PrismLook& look);

}  // namespace obliq
