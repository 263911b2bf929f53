#include "server/scene/grid_tiling.h"

#include <utility>

namespace obliq {
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
