#pragma once
#include <cstdint>
#include <vector>

#include "terrain/height_grid.h"

namespace obliq {

/// A rectangle of posts that are all known, for one grid primitive.
struct GridTile {
  std::size_t first_post;  ///< index of its lowest i and j
  int posts_x;
  int posts_z;
};

/// Covers the known cells of a grid with rectangles, so that no grid primitive touches an unknown node.
std::vector<GridTile> known_tiles(const HeightGrid& grid);

}  // namespace obliq
