#pragma once
#include "server/radar/geometry/sector.h"
#include "server/radar/simd/pixel_rays.h"

namespace obliq {

inline SwathTest swath_test(const SectorBox& box, const Sector& sector) {
  return {box.antenna_above_bottom_m, box.kappa_m, sector.r_min_m, sector.r_max_m};
}

}  // namespace obliq
