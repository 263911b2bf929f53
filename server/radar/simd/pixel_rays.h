#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"
#include "server/radar/simd/lanes.h"

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
  static constexpr int kMost = 1024;
  int n = 0;
  std::int32_t column[kMost];
  std::int32_t row[kMost];
  std::int32_t bin[kMost];
  double up_m[kMost];
  double ahead_m[kMost];
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

}  // namespace obliq
