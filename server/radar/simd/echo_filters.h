#pragma once
#include "server/radar/simd/kernel.h"

namespace obliq {

/// A beam's azimuths added up over part of a row, for neighbouring outputs together:
/// out[o][x] = sum of taps[j] rows[o step + j][x], j from 0 to n_taps - 1, in this order.
struct AzimuthSum {
  static constexpr int kOutputs = 4;
  const float* const* rows;  ///< [(kOutputs - 1) step + n_taps]; each of at least first + n floats
  int step;
  int n_taps;
  /// [n_taps + 2 (kOutputs - 1) step], zeros on either side of the taps.
  const float* padded_taps;
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
