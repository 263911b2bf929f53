#pragma once
#include <cstdint>

#include "server/radar/simd/grid_view.h"
#include "server/radar/simd/kernel.h"

namespace obliq {

/// Eight vertical profiles side by side on their way outwards through the grid. [8] of everything.
struct WalkingProfiles {
  static constexpr int kLanes = 8;
  double sin_bearing[kLanes];
  double cos_bearing[kLanes];
  double end_m[kLanes];  ///< where the profile leaves the grid; below d_m: nothing to march
  double d_m[kLanes];    ///< where it stands, and in which cell: whole numbers
  double i[kLanes];
  double j[kLanes];
};

/// Over bare ground: LineOfSight without roofs, to the bit.
struct SightProfiles : WalkingProfiles {
  double last_start_m;         ///< no cell that begins beyond is marched
  double horizon_d_m[kLanes];  ///< as in Horizon
  double horizon_h_m[kLanes];
  /// The width that the profile stands for, and up to where. After that those at `next`.
  double width_rad[kLanes];
  double width_to_m[kLanes];
  const double* next_width_rad[kLanes];
  const double* next_width_to_m[kLanes];  ///< the last one infinite
};

/// Visible segments of ground, as in VisibleSegment: (d, h) = (t, start + rise t), t from `from` to `to`. A
/// row holds at most one of each profile, so that what is made of rows in their order has each profile's
/// segments in theirs, whatever the other profiles see.
struct VisibleSegments {
  static constexpr int kMost = 64;
  using Row = double[SightProfiles::kLanes];
  int n = 0;
  unsigned seen[kMost];  ///< profiles that the row has a segment of, a bit each; what it has of others means
                         ///< nothing
  Row from_m[kMost];
  Row to_m[kMost];
  Row start_m[kMost];
  Row rise[kMost];
  Row plane_distance_m[kMost];
  Row width_rad[kMost];
  Row cell[kMost];  ///< j nx + i
};

/// Marches until the segments are full or every profile is at its end; false when nothing is left to march.
OBLIQ_KERNEL(bool, visible_ground, const GroundView&, SightProfiles&, VisibleSegments&);

}  // namespace obliq
