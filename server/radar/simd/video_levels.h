#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// Powers on a logarithmic scale: 0 of a power of 0, else 1 + round(steps_a_db (10 log10(power) - floor_db)),
/// from 1 to `most`. The arrays are read and written up to a multiple of 8.
struct VideoRun {
  int n;
  const double* power;  ///< finite, 0 or more
  double floor_db;
  double steps_a_db;
  double most;
  std::int32_t* level;
};
/// The same bits whatever the instruction set.
OBLIQ_KERNEL(void, video_levels, const VideoRun&);

}  // namespace obliq
