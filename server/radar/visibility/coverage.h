#pragma once
#include "server/radar/frame_plan.h"

namespace obliq {

/// How much of an azimuth bin's ground is known.
struct GroundArea {
  double sector_m2 = 0;   ///< between r_min and r_max at the median height
  double covered_m2 = 0;  ///< of that, over known ground
};

/// Along the centre of an azimuth bin.
GroundArea ground_area(const FramePlan& plan, int azimuth_bin);

}  // namespace obliq
