#pragma once
// Kernels of Doppler over a row of sharp bins: where its echoes stand, and a canceller of its own.
#include "server/radar/simd/lanes/kernel.h"
#include "server/radar/simd/receiver/canceller_lanes.h"

namespace obliq {

/// Doppler of a row of sharp bins, of what they hold: f = level_hz cos(e) + up_hz sin(e), in turns_a_hz f.
struct DopplerRow {
  int n;  ///< arrays are read and written up to a multiple of 8
  const float* sine;
  const double* turns_a_hz;
  double level_hz;
  double up_hz;
};

/// Where some neighbouring numbers lie: all within `reach` of `middle`.
struct CellSpan {
  static constexpr int kBins = 16;
  float middle;
  float reach;  ///< below 0: there are none
};

/// Cells, less those of level ground at the same azimuth and range, and where those lie that have power.
struct DopplerCells {
  DopplerRow row;           ///< n: a multiple of CellSpan::kBins
  double level_up_hz;       ///< up_hz of the level ground
  const float* level_sine;  ///< of level ground
  const float* power;
  float* beside_level;
  CellSpan* spans;  ///< [n / kBins]
};
OBLIQ_KERNEL(void, doppler_cells, const DopplerCells&);

/// Doppler of a row, in double.
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

}  // namespace obliq
