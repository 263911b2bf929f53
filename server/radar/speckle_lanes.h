#pragma once
#include <cstdint>

#include "server/radar/lane_grid.h"

namespace obliq {

/// What the response of ground cells follows from, besides the cells.
struct SpeckleGround {
  LaneGrid grid;
  double antenna_x_m, antenna_y_m, antenna_z_m;
  double wavelength_m;
  std::uint64_t seed;
};

/// Ground cells, and what they answer with.
struct SpeckleBlock {
  static constexpr int kMost = 256;
  int n = 0;
  std::int32_t x_cell[kMost];  ///< these five go in
  std::int32_t z_cell[kMost];
  std::uint32_t kind[kMost];  ///< level and material, as the hash takes them
  double side_m[kMost];
  double power_w[kMost];
  double
      re[kMost];  ///< these come out: sqrt(power) response; NaN where the cell's centre has no known ground
  double im[kMost];
};

/// The same bits whatever the instruction set.
using SpeckleKernel = void (*)(const SpeckleGround&, SpeckleBlock&);

}  // namespace obliq
