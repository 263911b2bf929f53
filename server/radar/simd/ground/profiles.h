#pragma once
// Vertical profiles that march over the ground, eight side by side, and the highest ground along one.
#include <cstdint>

#include "server/radar/simd/ground/grid_view.h"
#include "server/radar/simd/ground/horizon.h"
#include "server/radar/simd/ground/range_run.h"
#include "server/radar/simd/lanes/kernel.h"

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
  bool wants_planes = true;  ///< plane_distance_m is filled in
  unsigned seen[kMost];      ///< profiles that the row has a segment of, a bit each; what it has of others
                             ///< means nothing
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

/// What a march along a profile carries outwards, heights above the antenna.
template <typename Real>
struct ProfileState {
  Horizon<Real> horizon;
  RangeRun<Real> visible;  ///< the current connected stretches of what is seen
  RangeRun<Real> present;  ///< and of all that is there
  Real last_h_m{};
  Mask<Real> joined{};  ///< the next segment begins where the last one ended

  /// Passes a segment h = start + rise d from d0 to d1. Calls close(where) before other visible stretches
  /// begin.
  template <class Close>
  OBLIQ_INLINE void pass(Mask<Real> where, Real start, Real rise, Real d0, Real d1, const Close& close) {
    const Real h0 = start + rise * d0;
    const Real h1 = start + rise * d1;
    const RangeRun<Real> ranges = ranges_of(where, d0, h0, d1, h1);
    present.add(where, ranges);
    const auto seen = horizon.pass(where, start, rise, d0, d1, Mask<Real>{});
    const Mask<Real> goes_on = seen.any & inverse(seen.emerges);
    close(where & inverse(goes_on));
    visible.add(goes_on, ranges);
    if (any(seen.emerges))
      visible.add(seen.emerges, ranges_of(seen.emerges, seen.from, start + rise * seen.from, d1, h1));
    last_h_m = select(where, h1, last_h_m);
    joined = joined | where;
  }
};

/// Eight profiles over bare ground.
struct RangeProfiles : WalkingProfiles {
  double roof_m[kLanes];  ///< where the next roof begins; infinite without
  ProfileState<double> state[kLanes];
  std::uint8_t* visible[kLanes];  ///< [n_range] marks
  std::uint8_t* present[kLanes];
};

/// Marches until profiles come to cells with roofs, and returns a bit for each of those; 0 when all are at
/// their ends.
OBLIQ_KERNEL(unsigned, mark_visible_ranges, const GroundView&, const RangeAxis&, RangeProfiles&);

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
