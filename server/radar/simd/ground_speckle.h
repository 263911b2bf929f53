#pragma once
#include <cstdint>

#include "server/radar/simd/grid_view.h"
#include "server/radar/simd/kernel.h"

namespace obliq {

/// What the response of ground cells follows from, besides the cells.
struct SpeckleGround {
  GroundView view;
  double wavelength_m;
  std::uint64_t seed;
};

/// Scatterers as keys (ScattererKey), and what they answer with. The arrays are read and written up to a
/// multiple of 8.
struct SpeckleBlock {
  int n;
  const std::uint64_t* place;
  const std::uint64_t* kind;
  const double* power_w;
  double* re;  ///< sqrt(power) response, as if all were ground; NaN where a cell's centre has no known ground
  double* im;
};

/// The same bits whatever the instruction set.
OBLIQ_KERNEL(void, ground_speckle, const SpeckleGround&, const SpeckleBlock&);

}  // namespace obliq
