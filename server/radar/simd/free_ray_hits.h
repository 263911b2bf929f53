#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// Rays from the antenna over bare ground: unit directions, and a slant range before which each meets
/// nothing, at a point on the grid.
struct FreeRays {
  static constexpr double kOutOfSteps = -1;  ///< has crossed `most_cells` and met nothing so far
  const std::uint16_t* order;                ///< [n] the rays' numbers
  int n;
  int most_cells;
  double reach_m;   ///< slant range up to which they go
  double lowest_m;  ///< height above the antenna that no ground lies below
  const double* dir_x;
  const double* dir_y;
  const double* dir_z;
  double* from_m;   ///< of a ray that is out of steps: how far it has come
  double* range_m;  ///< slant range of what the ray meets first from above; NaN: nothing; or kOutOfSteps
};

OBLIQ_KERNEL(void, first_hits_on_ground, const GroundView&, const FreeRays&);

}  // namespace obliq
