#pragma once
// Kernels of Doppler: where rows of sharp bins stand, and sums over rows with weights that depend on it.
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// Doppler of a row of sharp bins, of what they hold: f = level_hz cos(e) + up_hz sin(e), in turns_a_hz f.
struct DopplerRow {
  int n;  ///< arrays are read and written up to a multiple of 8
  const float* sine;
  const double* turns_a_hz;
  double level_hz;
  double up_hz;
};
/// Turns, as they are.
struct DopplerCells {
  DopplerRow row;
  float* cells;
};
OBLIQ_KERNEL(void, doppler_cells, const DopplerCells&);

/// Doppler of a row, as DopplerCells has it, in double.
struct DopplerTurns {
  DopplerRow row;
  double* turns;
};
OBLIQ_KERNEL(void, doppler_turns, const DopplerTurns&);
/// sin and cos of half the turns.
struct DopplerPhasors {
  DopplerRow row;
  float* sin;
  float* cos;
};
OBLIQ_KERNEL(void, doppler_phasors, const DopplerPhasors&);

/// Echoes that move by themselves: what a canceller leaves of their power, sum of a[k] cos(k turns), k from 0
/// to 3.
struct MovingEchoes {
  float still;      ///< all of the a[k] together
  float turned[3];  ///< those from k = 1 on
};

/// A row behind a canceller of its own: voltages times w = (2 sin)^c / sqrt(noise gain), sin that of half the
/// turns, as at the middle of the canceller's pulses; powers times w^2. Of what moves the residue; I&Q keep
/// their phase, and the power that the row then has.
struct CancelledRow {
  int n;  ///< a multiple of 16
  int delays;
  float over_noise_root;
  const float* sin;
  const float* power;
  const float* moving;  ///< of that power; null: none
  MovingEchoes echoes;
  const float* iq;  ///< [n][2]; null: not wanted
  float* out_power;
  float* out_iq;
};
OBLIQ_KERNEL(void, cancel_row, const CancelledRow&);

/// Rows of which neighbouring outputs are sums, each with a weight of its own in each bin.
struct WeighedRows {
  static constexpr int kOutputs = 4;
  const float* const* power;  ///< [n_rows]
  const float* const* re;     ///< [n_rows]; null: I&Q are not wanted
  const float* const* im;
  int n_rows;
  int step;
  const std::int32_t* taps_at;  ///< [n_rows] of `taps`, less skipped + o step for output o
  int skipped;
  int first;
  int n;  ///< a multiple of 16
  float* out_power[kOutputs];
  float* out_iq[kOutputs];
};

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

/// A beam behind a canceller of an antenna that turns: the weight is the polynomial sum of taps[4 at + p]
/// u^p, u = 2 s (s + j c) with s and c of half the turns of the row, less those of the output, times (c + j
/// s)^c.
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

/// A response D(|cells|) in two ways: by values, linear between them, and by polynomials of degree four about
/// steps of their own, each good to a quarter of a cell.
struct DopplerTable {
  static constexpr int kStepsACell = 64;
  static constexpr int kPolynomialsACell = 8;
  static constexpr int kTerms = 5;
  const float* steps;
  float last_step;  ///< one more can be read
  const float* polynomials;
  int last_polynomial;
};

/// A beam sharpened by Doppler: the weight is taps[at] D(cells of the row less those of the output).
struct SharpenedSum {
  WeighedRows rows;
  const float* taps;
  const float* const* cells;  ///< [n_rows]
  const float* output_cells[WeighedRows::kOutputs];
  DopplerTable table;
  float period;  ///< cells, twice those of the table; 0: what is beyond has the last step's
};
OBLIQ_KERNEL(void, sharpened_sum, const SharpenedSum&);

}  // namespace obliq
