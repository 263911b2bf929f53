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

/// A row behind a canceller of its own: power times |u|^2c / noise_gain, I&Q times u^c over its root, with u
/// = 2 sin (sin + j cos) of half the turns. Of what moves the residue; I&Q keep their phase, and the power
/// that the row then has.
struct CancelledRow {
  int n;  ///< a multiple of 16
  int delays;
  float over_noise_gain;  ///< of power
  const float* sin;
  const float* cos;
  const float* power;
  const float* moving;  ///< of that power; null: none
  MovingEchoes echoes;
  const float* iq;  ///< [n][2]; null: not wanted
  float* out_power;
  float* out_iq;
};
OBLIQ_KERNEL(void, cancel_row, const CancelledRow&);

/// Rows of which an output is the sum, each with a weight of its own in each bin.
struct WeighedRows {
  const float* const* power;  ///< [n_rows]
  const float* const* iq;     ///< [n_rows] of [bins][2]; null: not wanted
  int n_rows;
  const std::int32_t* taps_at;  ///< [n_rows] of `taps`, less `skipped`
  int skipped;
  int first;
  int n;  ///< a multiple of 16
  float* out_power;
  float* out_iq;
};

/// A beam behind a canceller of an antenna that turns, or with a notch that follows the output: the weight
/// is the polynomial sum of taps[4 at + p] u^p, u = 2 s (s + j c) with s and c of half the turns of the row,
/// less those of the output.
struct CancelledSum {
  WeighedRows rows;
  const float* taps;        ///< [..][4]
  const float* const* sin;  ///< [n_rows]
  const float* const* cos;
  const float* output_sin;  ///< null: 0 turns
  const float* output_cos;
  int delays;
  const float* const* moving;  ///< [n_rows] of the powers; null: none
  const float* power_taps;     ///< that these have
  MovingEchoes echoes;
};
OBLIQ_KERNEL(void, cancelled_sum, const CancelledSum&);

/// A beam sharpened by Doppler: the weight is taps[at] D(cells of the row less those of the output), D linear
/// between the entries of a table.
struct SharpenedSum {
  WeighedRows rows;
  const float* taps;
  const float* const* cells;  ///< [n_rows]
  const float* output_cells;
  const float* table;  ///< of |cells|
  float steps_a_cell;
  float last_step;  ///< of the table; one more can be read
  float period;     ///< cells; 0: there is none
  bool alternates;  ///< the sign does, from period to period
};
OBLIQ_KERNEL(void, sharpened_sum, const SharpenedSum&);

}  // namespace obliq
