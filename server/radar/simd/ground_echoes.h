#pragma once
#include <cstdint>

#include "server/radar/simd/cross_section.h"
#include "server/radar/simd/kernel.h"
#include "server/radar/simd/range_axis.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// The range bins that segments of ground are cut into, and what eight profiles have in common.
struct GroundCut {
  RangeAxis axis;
  EchoTable echo;
  const std::uint8_t* material;  ///< [nz - 1][nx - 1] of the cells; null: all are 0
  int nx;
  /// [n_range][8] share of a profile's light that buildings leave to the ground of a bin; null: all of it.
  const float* kept;
};

/// The ground that a profile sees of a range bin: its power, and where it begins. One of each profile is on
/// the way; the others are in the list, in the order in which they ended. [kMost] of everything.
struct GroundEchoes {
  static constexpr int kMost = 512;
  static constexpr int kSpare = 8;  ///< elements that may be written behind the last one
  /// On the way: range bin, whole numbers; -1: none.
  double bin_now[SightProfiles::kLanes];
  double distance_now_m[SightProfiles::kLanes];
  double power_now_w[SightProfiles::kLanes];
  double material_now[SightProfiles::kLanes];
  int n;
  std::uint32_t at[kMost + kSpare];   ///< range bin x 8 + profile
  double distance_m[kMost + kSpare];  ///< ground distance of the middle of the first part
  double power_w[kMost + kSpare];
  std::uint32_t material[kMost + kSpare];
};

/// Adds rows of segments from number `first` on; returns the first that is not done: all are, or the list is
/// full, and what is left of the row stays in `segments`.
OBLIQ_KERNEL(int, ground_echoes, const GroundCut&, VisibleSegments&, int first, GroundEchoes&);

}  // namespace obliq
