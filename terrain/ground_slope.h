#pragma once
#include "terrain/height_grid.h"

namespace obliq {

/// Of the triangle under a place: its cell, its rise for a metre of x and z, and its height at the place.
struct GroundSlope {
  bool known = false;
  int i = 0, j = 0;
  double per_x = 0, per_z = 0;
  double y_m = 0;
};

inline GroundSlope ground_slope_at(const HeightGrid& grid, double x_m, double z_m) {
  const double per_m = 1 / grid.cell_m;
  const double u = (x_m - grid.x0_m) * per_m;
  const double v = (z_m - grid.z0_m) * per_m;
  if (!(u >= 0 && v >= 0 && u < grid.nx - 1 && v < grid.nz - 1)) return {};
  const auto i = static_cast<int>(u);
  const auto j = static_cast<int>(v);
  if (!grid.cell_known(i, j)) return {};
  const int upper = (u - i) + (v - j) > 1 ? 1 : 0;  // the triangle at node (i + 1, j + 1)
  const double along_x = grid.node_y_m(i + 1, j + upper) - grid.node_y_m(i, j + upper);
  const double along_z = grid.node_y_m(i + upper, j + 1) - grid.node_y_m(i + upper, j);
  const double y_m =
      grid.node_y_m(i + upper, j + upper) + along_x * (u - i - upper) + along_z * (v - j - upper);
  return {true, i, j, along_x * per_m, along_z * per_m, y_m};
}

}  // namespace obliq
