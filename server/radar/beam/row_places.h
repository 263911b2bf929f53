#pragma once
#include <cstddef>
#include <vector>

#include "server/radar/doppler/doppler_plan.h"
#include "server/radar/simd/receiver/row_doppler.h"

namespace obliq {

/// Where the echoes of a row of sharp bins stand in Doppler.
struct RowPlaces {
  double level_hz = 0;  ///< of level ground
  /// [stride] sine and cosine of half the turns between two pulses (mti); or cells beside level ground
  /// (DopplerCells) and nothing.
  std::vector<float> first, second;
  std::vector<CellSpan> spans;  ///< where the cells lie, of modes other than mti

  /// level_hz is there. sine: of elevations; power: that the cells count for, of mti nothing; up_hz: Doppler
  /// straight up.
  void place(const DopplerPlan& doppler, std::size_t stride, const float* sine, const float* power,
             double up_hz);
};

}  // namespace obliq
