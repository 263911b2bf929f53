#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"
#include "server/radar/simd/range_axis.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// The range bins that segments are cut into, and what the profiles of the segments have in common.
struct SegmentCut {
  RangeAxis axis;
  GroundView ground;
  double turn_rad;  ///< PieceSampler::kTurn_rad
  double sin_bearing[SightProfiles::kLanes];
  double cos_bearing[SightProfiles::kLanes];
  double azimuth_offset_rad[SightProfiles::kLanes];
  double azimuth_bin[SightProfiles::kLanes];  ///< whole numbers
  const std::uint8_t* material;               ///< [nz - 1][nx - 1] of the cells; null: all are 0
};

/// The arrays of a SampleBatch.
struct SampleArrays {
  static constexpr int kRoom = 8;                        ///< what is written behind the last sample
  static constexpr std::uint32_t kGround = 0xffffffffu;  ///< kNoFace
  int n;
  int most;
  std::int32_t* azimuth_bin;
  double* slant_range_m;
  double* solid_angle_sr;
  double* cos_incidence;
  double* azimuth_offset_rad;
  double* sin_elevation;
  double* x_m;
  double* z_m;
  std::uint32_t* face;
  std::uint8_t* material;
};

/// Cuts rows of segments from number `first` on into samples as PieceSampler does. Returns the
/// first one that is not done: all are, or there is no room, or a segment of the next row is rare (its range
/// turns, it is seen under a wide angle, or it has very many bins) and `rare` is set.
OBLIQ_KERNEL(int, cut_at_range_bins, const SegmentCut&, const VisibleSegments&, int first, SampleArrays&,
             bool& rare);

}  // namespace obliq
