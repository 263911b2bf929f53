#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// The surface of a ray that passes under the far edge of a void.
constexpr std::uint32_t kUnderVoid = 0xfffffffeu;

/// Rays that all profiles have, by rising elevation: [n + 1] of each, the last slope infinite.
struct RayRows {
  const double* slope;   ///< tangent of the elevation
  const double* secant;  ///< slant range a metre of ground distance
  std::uint64_t n;
};

/// Eight vertical profiles over bare ground that answer their rays on their way outwards.
struct RayProfiles : WalkingProfiles {
  double roof_m[kLanes];       ///< no cell that reaches so far is entered
  std::uint64_t next[kLanes];  ///< the first ray that lies above all that is nearer
  double* slant_range_m;       ///< [8][rays]
  std::uint32_t* surface;      ///< [8][rays], as in ProfileRays
};

/// Marches until every profile is at its end, has answered its rays or stands before a roof; a bit for each
/// that stands before a roof.
OBLIQ_KERNEL(unsigned, first_hits_in_profiles, const GroundView&, const RayRows&, RayProfiles&);

}  // namespace obliq
