#pragma once
#include "server/radar/simd/kernel.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// The stretch of a vertical profile between two ground distances.
struct ProfileStretch {
  double sin_bearing, cos_bearing;
  double from_m, to_m;
};

/// A point of a profile: ground distance and height above the antenna.
struct HorizonPoint {
  double d_m, h_m;
};

/// The point of highest elevation among those where the profile crosses an edge of the ground's triangles,
/// ends included; d_m 0 where it crosses none. The cells along the stretch must be known.
OBLIQ_KERNEL(HorizonPoint, highest_ground, const GroundView&, const ProfileStretch&);

}  // namespace obliq
