#pragma once
#include <cstdint>

#include "server/radar/simd/horizon.h"
#include "server/radar/simd/kernel.h"
#include "server/radar/simd/range_run.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// What a march along a profile carries outwards, heights above the antenna.
struct ProfileState {
  Horizon<double> horizon;
  RangeRun<double> visible;  ///< the connected stretches at hand, of what is seen
  RangeRun<double> present;  ///< and of all that is there
  double last_h_m = 0;
  bool joined = false;  ///< the next segment begins where the last one ended
};

/// Eight profiles over bare ground.
struct RangeProfiles : WalkingProfiles {
  double roof_m[kLanes];  ///< where the next roof begins; infinite without
  ProfileState state[kLanes];
  std::uint8_t* visible[kLanes];  ///< [n_range] marks
  std::uint8_t* present[kLanes];
};

/// Marches until profiles come to cells with roofs, and returns a bit for each of those; 0 when all are at
/// their ends.
OBLIQ_KERNEL(unsigned, mark_visible_ranges, const GroundView&, const RangeAxis&, RangeProfiles&);

}  // namespace obliq
