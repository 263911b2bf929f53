#pragma once
#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// What the sub-columns of an azimuth bin saw of walls and roofs, a piece a range bin, [kMost] of everything.
/// Read and written up to a multiple of 8.
struct FacePieces {
  static constexpr int kMost = 64;
  int n = 0;
  // As PartEchoes has them.
  float solid_angle_sr[kMost]{}, range_m[kMost]{}, middle_m[kMost]{}, tangent_sr[kMost]{};
  float roof_m[kMost]{}, base_m[kMost]{};  ///< above the antenna
  // The wall's ends to the right of the bin's middle, and ahead; both 0 of a roof.
  float right0_m[kMost]{}, ahead0_m[kMost]{}, right1_m[kMost]{}, ahead1_m[kMost]{};
  // Found: the middle of the piece, in the world frame, and 1 / cos^2 of the incidence.
  double x_m[kMost], y_m[kMost], z_m[kMost];
  double sec2[kMost];
};

/// An azimuth bin as its faces need it: where the antenna stands, and the bearing of the bin's middle.
struct BinAxes {
  double antenna_x_m, antenna_y_m, antenna_z_m;
  SinCos bearing;
};

/// Works out where the pieces lie.
OBLIQ_KERNEL(void, face_places, const BinAxes&, FacePieces&);

}  // namespace obliq
