#pragma once
#include <cstdint>

#include "server/radar/samples.h"
#include "server/radar/simd/echoes/range_axis.h"
#include "server/radar/simd/ground/profiles.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// The range bins that segments are cut into, and what the profiles of the segments have in common.
struct SegmentCut {
  RangeAxis axis;
  GroundView ground;
  double turn_rad;  ///< SegmentSampler::kMostTurn_rad
  double sin_bearing[SightProfiles::kLanes];
  double cos_bearing[SightProfiles::kLanes];
  double azimuth_offset_rad[SightProfiles::kLanes];
  double azimuth_bin[SightProfiles::kLanes];  ///< whole numbers
  const std::uint8_t* material;               ///< [nz - 1][nx - 1] of the cells; null: all are 0
  const float* raster_gamma;                  ///< [nz - 1][nx - 1] of the cells; null: there is none
};

/// Cuts rows of segments from number `first` on into samples as SegmentSampler does. Returns the
/// first one that is not done: all are, or there is no room, or a segment of the next row is rare (its range
/// turns, it is seen under a wide angle, or it has very many bins) and `rare` is set.
OBLIQ_KERNEL(int, cut_at_range_bins, const SegmentCut&, const VisibleSegments&, int first, SampleBatch&,
             bool& rare);

}  // namespace obliq
