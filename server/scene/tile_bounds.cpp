#include "server/scene/tile_bounds.h"

#include <algorithm>
#include <limits>

namespace obliq {

TileBounds::TileBounds(const HeightGrid& grid, int cells)
    : cells_(cells),
      lowest_m_(std::numeric_limits<double>::infinity()),
      tiles_x_((grid.nx - 2) / cells + 1),
      tiles_z_((grid.nz - 2) / cells + 1) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  tiles_.reserve(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_z_));
  for (int tj = 0; tj < tiles_z_; ++tj) {
    for (int ti = 0; ti < tiles_x_; ++ti) {
      Tile tile{kInfinity, -kInfinity, true};
      const int i_end = std::min(grid.nx, (ti + 1) * cells + 1);
      const int j_end = std::min(grid.nz, (tj + 1) * cells + 1);
      for (int j = tj * cells; j < j_end; ++j) {
        for (int i = ti * cells; i < i_end; ++i) {
          const float y = grid.y_m[grid.index(i, j)];
          // Comparisons with NaN are false: unknown nodes bound nothing.
          if (y < tile.lowest_m) tile.lowest_m = y;
          if (y > tile.highest_m) tile.highest_m = y;
          if (y != y) tile.whole = false;
        }
      }
      lowest_m_ = std::min(lowest_m_, static_cast<double>(tile.lowest_m));
      tiles_.push_back(tile);
    }
  }
}

}  // namespace obliq
