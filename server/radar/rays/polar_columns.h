#pragma once
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/simd/exact_math.h"

namespace obliq {

/// A column of the polar frustum's pixels: one vertical plane.
struct PolarColumn {
  int index;
  int azimuth_bin;
  SinCos offset;  ///< of its bearing from the sector's centre
};

/// Those of some azimuth bins, in order of bearing: column c belongs to the bin of its centre.
std::vector<PolarColumn> polar_columns(const FramePlan& plan, AzimuthRange range);

}  // namespace obliq
