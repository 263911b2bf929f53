#pragma once
#include "server/radar/geometry/sector.h"

namespace obliq {

/// Whether a ray of some elevation can hit anything of the sector's box between r_min and r_max.
struct SwathTest {
  double below_bottom_m;
  double below_top_m;
  double r_min_m;
  double r_max_m;

  SwathTest(const SectorBox& box, const Sector& sector)
      : below_bottom_m(box.antenna_above_bottom_m),
        below_top_m(box.kappa_m),
        r_min_m(sector.r_min_m),
        r_max_m(sector.r_max_m) {}

  bool reaches(double sin_elevation) const {
    if (sin_elevation < 0) {
      // The box's ground lies between these ranges along the ray.
      if (below_bottom_m < -sin_elevation * r_min_m) return false;
      return below_top_m <= -sin_elevation * r_max_m;
    }
    return below_top_m <= 0 && -below_top_m >= sin_elevation * r_min_m;
  }
};

}  // namespace obliq
