#pragma once
#include <cstdint>

#include "server/radar/simd/grid_view.h"
#include "server/radar/simd/kernel.h"

namespace obliq {

/// Rays from the antenna: unit directions, and how far the tracer says that each goes to the ground; NaN for
/// one that met no ground. The arrays are read up to a multiple of 8.
struct RoughHits {
  GroundView view;
  int n;
  const double* dir_x;
  const double* dir_y;
  const double* dir_z;
  const double* rough_m;
};

/// Where they meet the ground in double precision: what refine_near (server/scene/exact_hit.h) answers.
struct GroundHits {
  static constexpr int kMost = 1024;
  double slant_range_m[kMost];  ///< NaN: to be answered otherwise
  double cos_incidence[kMost];
  double x_m[kMost];
  double z_m[kMost];
  std::int32_t cell_x[kMost];  ///< the ground cell
  std::int32_t cell_z[kMost];
};

/// Intersects the triangle under each rough hit, and the one under the point that this leads to. Rays that
/// neither answers, a few in a hundred, are left: those that leaked, and those next to a silhouette.
OBLIQ_KERNEL(void, refine_ground_hits, const RoughHits&, GroundHits&);

}  // namespace obliq
