#pragma once
#include <cstdint>

#include "server/radar/samples.h"
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
  double slant_range_m[kBatch];  ///< NaN: to be answered otherwise
  double cos_incidence[kBatch];
  double x_m[kBatch];
  double z_m[kBatch];
  std::int32_t cell_x[kBatch];  ///< the ground cell
  std::int32_t cell_z[kBatch];
};

/// Intersects the triangle under each rough hit, and the one under the point that this leads to. Rays that
/// neither answers, a few in a hundred, are left: those that leaked, and those next to a silhouette.
OBLIQ_KERNEL(void, refine_ground_hits, const RoughHits&, GroundHits&);

}  // namespace obliq
