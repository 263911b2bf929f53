#include "server/scene/tile_bounds.h"

#include <algorithm>
#include <limits>

#include "terrain/base/parallel.h"

namespace obliq {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr TileBounds::Tile kNothing{kInfinity, -kInfinity, true};

std::size_t count(int columns, int rows) {
  return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

TileBounds::Tile bounds_of(const HeightGrid& grid, int i0, int j0, int i_end, int j_end) {
  TileBounds::Tile tile = kNothing;
  for (int j = j0; j < j_end; ++j) {
    for (int i = i0; i < i_end; ++i) {
      const float y = grid.y_m[grid.index(i, j)];
      // Comparisons with NaN are false: unknown nodes bound nothing.
      if (y < tile.lowest_m) tile.lowest_m = y;
      if (y > tile.highest_m) tile.highest_m = y;
      if (y != y) tile.whole = false;
    }
  }
  return tile;
}

void join(TileBounds::Tile& tile, const TileBounds::Tile& other) {
  tile.lowest_m = std::min(tile.lowest_m, other.lowest_m);
  tile.highest_m = std::max(tile.highest_m, other.highest_m);
  tile.whole = tile.whole && other.whole;
}

}  // namespace

TileBounds::TileBounds(const HeightGrid& grid, int cells)
    : cells_(cells),
      tiles_x_((grid.nx - 2) / cells + 1),
      tiles_z_((grid.nz - 2) / cells + 1),
      tiles_(count(tiles_x_, tiles_z_)) {
  for_each_row(tiles_z_, [&](int tj) {
    for (int ti = 0; ti < tiles_x_; ++ti)
      tiles_[index(ti, tj)] = bounds_of(grid, ti * cells, tj * cells, std::min(grid.nx, (ti + 1) * cells + 1),
                                        std::min(grid.nz, (tj + 1) * cells + 1));
  });
  sum_up();
}

TileBounds::TileBounds(const TileBounds& finer, int factor)
    : cells_(finer.cells_ * factor),
      tiles_x_((finer.tiles_x_ - 1) / factor + 1),
      tiles_z_((finer.tiles_z_ - 1) / factor + 1),
      tiles_(count(tiles_x_, tiles_z_), kNothing) {
  for (int tj = 0; tj < finer.tiles_z_; ++tj)
    for (int ti = 0; ti < finer.tiles_x_; ++ti)
      join(tiles_[index(ti / factor, tj / factor)], finer.tile(ti, tj));
  sum_up();
}

void TileBounds::sum_up() {
  all_ = kNothing;
  for (const Tile& tile : tiles_) join(all_, tile);
}

}  // namespace obliq
