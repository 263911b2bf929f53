#include "server/scene/tile_bounds.h"

#include <algorithm>
#include <limits>
#include <utility>

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

namespace {

constexpr int kMaxGridSide = 32767;  // Embree's limit on the resolution of one grid primitive

class GridTiling {
 public:
  explicit GridTiling(const HeightGrid& grid) : grid_(grid) {
    bool all_known = true;
    for (float y : grid.y_m) all_known = all_known && y == y;
    if (!all_known) count_known_cells();
    split(0, 0, grid.nx - 1, grid.nz - 1);
  }
  std::vector<GridTile> take() { return std::move(tiles_); }

 private:
  void count_known_cells() {
    // known_[j][i] = known cells in [0, i) x [0, j)
    const auto width = static_cast<std::size_t>(grid_.nx);
    known_.assign(width * static_cast<std::size_t>(grid_.nz), 0);
    for (int j = 0; j + 1 < grid_.nz; ++j)
      for (int i = 0; i + 1 < grid_.nx; ++i)
        known_[grid_.index(i + 1, j + 1)] = (grid_.cell_known(i, j) ? 1u : 0u) +
                                            known_[grid_.index(i, j + 1)] + known_[grid_.index(i + 1, j)] -
                                            known_[grid_.index(i, j)];
  }

  std::uint32_t known_in(int i0, int j0, int i1, int j1) const {
    if (known_.empty()) return static_cast<std::uint32_t>(i1 - i0) * static_cast<std::uint32_t>(j1 - j0);
    return known_[grid_.index(i1, j1)] - known_[grid_.index(i0, j1)] - known_[grid_.index(i1, j0)] +
           known_[grid_.index(i0, j0)];
  }

  void split(int i0, int j0, int i1, int j1) {
    const int wide = i1 - i0;
    const int high = j1 - j0;
    const std::uint32_t known = known_in(i0, j0, i1, j1);
    if (known == 0) return;
    const bool full = known == static_cast<std::uint32_t>(wide) * static_cast<std::uint32_t>(high);
    if (full && wide < kMaxGridSide && high < kMaxGridSide) {
      tiles_.push_back({grid_.index(i0, j0), wide + 1, high + 1});
    } else if (wide >= high) {
      split(i0, j0, i0 + wide / 2, j1);
      split(i0 + wide / 2, j0, i1, j1);
    } else {
      split(i0, j0, i1, j0 + high / 2);
      split(i0, j0 + high / 2, i1, j1);
    }
  }

  const HeightGrid& grid_;
  std::vector<std::uint32_t> known_;
  std::vector<GridTile> tiles_;
};

}  // namespace

std::vector<GridTile> known_tiles(const HeightGrid& grid) { return GridTiling(grid).take(); }

}  // namespace obliq
