#pragma once
#include <cstdint>

#include "server/radar/samples.h"
#include "server/radar/simd/range_axis.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// The range bins that pieces are cut into, and what the planes of the pieces have in common.
struct PieceBins {
  RangeAxis axis;
  GroundView ground;
  double turn_rad;  ///< SegmentSampler::kTurn_rad
  double sin_bearing[GroundLanes::kLanes];
  double cos_bearing[GroundLanes::kLanes];
  double azimuth_offset_rad[GroundLanes::kLanes];
  double azimuth_bin[GroundLanes::kLanes];  ///< whole numbers
  const std::uint8_t* material;             ///< [nz - 1][nx - 1] of the cells; null: all are 0
};

/// Cuts rows of pieces from number `first` on into samples as SegmentSampler does, to the bit. Returns the
/// first one that is not done: all are, or there is no room, or a piece of the next row is rare (its range
/// turns, it is seen under a wide angle, or it has very many bins) and `rare` is set.
using PieceKernel = int (*)(const PieceBins&, const GroundPieces&, int first, SampleBatch&, bool& rare);

}  // namespace obliq
