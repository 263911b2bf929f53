#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// A beam's azimuths added up over part of a row, for neighbouring outputs together, each row with weights of
/// its own: out[o][x] = sum of taps[taps_at[k] - skipped - o step] rows[k][x], k from 0 to n_rows - 1, in
/// this order.
struct AzimuthSum {
  static constexpr int kOutputs = 4;
  const float* const* rows;  ///< [n_rows]; each of at least first + n floats
  int n_rows;
  int step;
  const float* taps;            ///< of all sets of weights
  const std::int32_t* taps_at;  ///< [n_rows]
  int skipped;
  int first;
  int n;  ///< a multiple of 16
  float* out[kOutputs];
};
OBLIQ_KERNEL(void, azimuth_sum, const AzimuthSum&);

/// A pulse's ranges added up over a row: out[x] = sum of taps[j] in[x + j stride]. Two for complex numbers.
struct RangeSum {
  int stride;
  int n_taps;
  const float* taps;
  const float* in;  ///< read up to a multiple of 16 floats beyond n + n_taps stride
  int n;
  float* out;  ///< written up to a multiple of 16
};
OBLIQ_KERNEL(void, range_sum, const RangeSum&);

}  // namespace obliq
