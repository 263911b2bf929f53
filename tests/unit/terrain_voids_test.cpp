#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "terrain/dem/resample.h"

namespace obliq {
namespace {

/// 40 x 30 nodes of 10 m on the plane y = 3 + x/10 - z/20.
HeightGrid plane() {
  HeightGrid grid;
  grid.cell_m = 10;
  grid.nx = 40;
  grid.nz = 30;
  for (int j = 0; j < grid.nz; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      grid.y_m.push_back(static_cast<float>(3 + grid.node_x_m(i) / 10 - grid.node_z_m(j) / 20));
    }
  }
  return grid;
}

void clear(HeightGrid& grid, int i0, int i1, int j0, int j1) {
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
  }
}

TEST(Voids, SmallOnesAreFilledExactlyOnAPlane) {
  const HeightGrid whole = plane();
  HeightGrid grid = plane();
  clear(grid, 10, 14, 10, 14);
  EXPECT_EQ(fill_voids(grid, 50).size(), 25u);
  for (std::size_t n = 0; n < grid.y_m.size(); ++n) ASSERT_NEAR(grid.y_m[n], whole.y_m[n], 1e-5);
}

TEST(Voids, AVoidOneNodeWiderThanAllowedStaysWhole) {
  HeightGrid grid = plane();
  clear(grid, 10, 15, 10, 15);
  EXPECT_TRUE(fill_voids(grid, 50).empty());
  EXPECT_FALSE(grid.node_known(10, 10));
}

TEST(Voids, ALongNarrowGapIsNarrow) {
  HeightGrid grid = plane();
  clear(grid, 2, 37, 10, 11);
  EXPECT_EQ(fill_voids(grid, 20).size(), 72u);
}

TEST(Voids, GroundIsNotInventedBeyondTheBorder) {
  HeightGrid grid = plane();
  clear(grid, 0, 1, 0, 29);
  EXPECT_TRUE(fill_voids(grid, 50).empty());
}

TEST(Voids, ZeroWidthFillsNothing) {
  HeightGrid grid = plane();
  clear(grid, 10, 10, 10, 10);
  EXPECT_TRUE(fill_voids(grid, 0).empty());
}

}  // namespace
}  // namespace obliq
