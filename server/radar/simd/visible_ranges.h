#pragma once
#include <cstdint>

#include "server/radar/simd/horizon.h"
#include "server/radar/simd/kernel.h"
#include "server/radar/simd/range_run.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// What a march along a profile carries outwards, heights above the antenna.
template <typename Real>
struct ProfileState {
  Horizon<Real> horizon;
  RangeRun<Real> visible;  ///< the connected stretches at hand, of what is seen
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

}  // namespace obliq
