#pragma once
// Kernels of pulse trains: rows of sharp bins that turn from pulse to pulse, added up.
#include <cstddef>

#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// Pulses of 16 neighbouring bins: pulse k at start_s + k step_s is given, of all rows in their order,
///   gain v exp(j 2 pi hz t).
/// A phasor is multiplied on from one pulse to the next in floats, and worked out anew every kRenewed pulses.
struct PulseSum {
  static constexpr int kRenewed = 16;
  const double* const* hz;  ///< [n_rows], as what follows
  const float* const* re;   ///< of v
  const float* const* im;
  const float* const* gains;  ///< of each pulse, or one for all
  bool has_gain_a_pulse;
  int n_rows;
  int first;  ///< bin
  double start_s;
  double step_s;
  int n_pulses;
  /// Added to: [n_pulses][stride].
  float* out_re;
  float* out_im;
  std::size_t stride;
};
OBLIQ_KERNEL(void, pulse_sum, const PulseSum&);

/// A row of bins times exp(j 2 pi turns[m] times).
struct TurnedRow {
  int n;  ///< a multiple of 16
  const double* turns;
  double times;
  float* re;
  float* im;
};
OBLIQ_KERNEL(void, turn_row, const TurnedRow&);

}  // namespace obliq
