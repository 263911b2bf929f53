#pragma once
// Rays from the antenna: through pixels, over bare ground to what each meets first, and those hits in double.
#include <cstdint>

#include "server/radar/samples.h"
#include "server/radar/simd/ground/grid_view.h"
#include "server/radar/simd/ground/profiles.h"
#include "server/radar/simd/lanes/kernel.h"
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

/// Whether a ray of some elevation can meet anything of the sector's box between r_min and r_max.
struct SwathTest {
  double below_bottom_m, below_top_m;  ///< of the box, the antenna's height above
  double r_min_m, r_max_m;

  template <typename Real>
  OBLIQ_INLINE Mask<Real> reaches(Real sin_elevation) const {
    const Mask<Real> below = sin_elevation < 0.0;
    // The box's ground lies between these ranges along the ray.
    const Mask<Real> ground =
        (below_bottom_m >= -sin_elevation * r_min_m) & (below_top_m <= -sin_elevation * r_max_m);
    const Mask<Real> above =
        (broadcast<Real>(below_top_m) <= 0.0) & (-below_top_m >= sin_elevation * r_min_m);
    return (below & ground) | (inverse(below) & above);
  }
};

/// A perspective frustum and the swath that its rays are to reach (PerspectiveFrustum, Sector).
struct PixelCamera {
  double left_m, pixel_width_m;
  double sin_bearing, cos_bearing;
  double solid_angle_m3;  ///< a pixel's, times the cube of its distance
  double wide_m2;         ///< below this square of its distance its solid angle is left to others
  SwathTest swath;
  double half_pixel_m;  ///< a plate that is spread may reach into the swath from so far outside; 0: it is not
                        ///< spread
};

/// Pixels, each in its azimuth bin, and the viewing plane's up and ahead in its row.
struct PixelList {
  int n = 0;
  std::int32_t column[kBatch];
  std::int32_t row[kBatch];
  std::int32_t bin[kBatch];
  double up_m[kBatch];
  double ahead_m[kBatch];
};

/// Rays of the pixels that reach the swath, in their order; `from` is the pixel's place in the list. All
/// arrays are written up to a multiple of 8.
struct PixelRays {
  double* dir_x;
  double* dir_y;
  double* dir_z;
  double* solid_angle_sr;  ///< NaN: left to others
  std::int32_t* from;
};

/// Returns the number of rays.
OBLIQ_KERNEL(int, pixel_rays, const PixelCamera&, const PixelList&, const PixelRays&);

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
