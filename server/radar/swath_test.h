#pragma once
#include "server/radar/frame_plan.h"

namespace obliq {

/// Whether a ray of some elevation can meet anything of the sector's box between r_min and r_max.
struct SwathTest {
  double below_bottom_m;
  double below_top_m;
  double r_min_m;
  double r_max_m;

  explicit SwathTest(const FramePlan& plan)
      : below_bottom_m(plan.box().antenna_above_bottom_m),
        below_top_m(plan.box().kappa_m),
        r_min_m(plan.sector().r_min_m),
        r_max_m(plan.sector().r_max_m) {}

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
