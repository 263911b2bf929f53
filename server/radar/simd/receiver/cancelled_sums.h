#pragma once
// Kernels of a beam behind a canceller: weights that depend on the Doppler of each bin of each row.
#include "server/radar/simd/lanes/kernel.h"
#include "server/radar/simd/receiver/canceller_lanes.h"
#include "server/radar/simd/receiver/weighed_rows.h"

namespace obliq {

/// A beam behind a canceller whose notch follows the output: w of the turns of a row less those of the
/// output.
struct LockedSum {
  WeighedRows rows;
  const float* taps;
  const float* const* sin;  ///< [n_rows] of half the turns
  const float* const* cos;
  const float* output_sin[WeighedRows::kOutputs];
  const float* output_cos[WeighedRows::kOutputs];
  int delays;
  float over_noise_root;
  const float* const* moving;  ///< [n_rows] of the powers; null: none
  const float* power_taps;     ///< that these have
  MovingEchoes echoes;
};
OBLIQ_KERNEL(void, locked_sum, const LockedSum&);

/// A beam behind a canceller of an antenna that turns, as at the middle of its pulses (CancellerTerms): with
/// s and c of half the turns of the row, less those of the output, and y = 4 s^2, the weight is even (taps[0]
/// + taps[1] y) + j odd (taps[2] + taps[3] y); even = 1 and odd = 2 s c of two delays, c and s of one and
/// three.
struct CancelledSum {
  WeighedRows rows;
  const float* taps;        ///< [..][4]
  const float* const* sin;  ///< [n_rows]
  const float* const* cos;
  const float* output_sin[WeighedRows::kOutputs];  ///< null: 0 turns
  const float* output_cos[WeighedRows::kOutputs];
  int delays;
  const float* const* moving;  ///< [n_rows] of the powers; null: none
  const float* power_taps;     ///< that these have
  MovingEchoes echoes;
};
OBLIQ_KERNEL(void, cancelled_sum, const CancelledSum&);

}  // namespace obliq
