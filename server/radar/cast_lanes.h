#pragma once
#include "server/radar/ground_lanes.h"

namespace obliq {

/// Rays from the antenna over bare ground: unit directions, and a slant range before which each meets
/// nothing, at a point on the grid; infinite for one that meets nothing at all.
struct CastRays {
  static constexpr double kUnder = -1;  ///< the ray passes under the far edge of a void
  int n;
  const double* dir_x;
  const double* dir_y;
  const double* dir_z;
  const double* from_m;
  double* range_m;  ///< slant range of what the ray meets first; NaN: nothing; or kUnder
};

using CastKernel = void (*)(const GroundScene&, const CastRays&);

}  // namespace obliq
