#pragma once
#include <cstdint>

#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// What a march along a profile carries outwards, heights above the antenna (ProfileMarch).
struct ProfileState {
  double horizon_d_m = 0;
  double horizon_h_m = -1;
  double visible_least2 = __builtin_inf();  ///< squares of the range of the stretch at hand
  double visible_greatest2 = -1;            ///< negative: no stretch
  double present_least2 = __builtin_inf();
  double present_greatest2 = -1;
  double last_h_m = 0;
  double joined = 0;  ///< 1: the next piece begins where the last one ended
};

/// Eight profiles over bare ground.
struct ProfileLanes : WalkingPlanes {
  double roof_m[kLanes];  ///< where the next roof begins; infinite without
  ProfileState state[kLanes];
  std::uint8_t* visible[kLanes];  ///< [n_range] marks
  std::uint8_t* present[kLanes];
};

/// The range bins.
struct ProfileBins {
  int n_range;
  double r_min_m, r_max_m, range_spacing_m;
};

/// Marches until planes come to cells with roofs, and returns a bit for each of those; 0 when all are at
/// their ends.
using ProfileKernel = unsigned (*)(const GroundScene&, const ProfileBins&, ProfileLanes&);

}  // namespace obliq
