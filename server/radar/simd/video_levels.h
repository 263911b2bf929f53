#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// Means of `looks` independent exponential numbers of mean 1: Gamma(looks) / looks. Number k follows from
/// the key and cell + k alone. `mean` is written up to a multiple of 8.
struct LooksRun {
  std::uint64_t key;
  std::uint64_t cell;
  int n;
  int looks;  ///< 2 or more
  double* mean;
};

/// The same bits whatever the instruction set.
OBLIQ_KERNEL(void, mean_of_looks, const LooksRun&);

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
OBLIQ_KERNEL(void, video_levels, const VideoRun&);

}  // namespace obliq
