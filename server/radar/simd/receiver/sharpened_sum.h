#pragma once
// Kernel of a beam sharpened by Doppler.
#include "server/radar/simd/receiver/row_doppler.h"
#include "server/radar/simd/receiver/weighed_rows.h"

namespace obliq {

/// A response D of cells in two ways: by values, linear between them, and by polynomials of degree four about
/// steps of their own, each good to a quarter of a cell.
struct DopplerTable {
  static constexpr int kStepsACell = 64;
  static constexpr int kPolynomialsACell = 8;
  static constexpr int kTerms = 5;
  const float* steps;        ///< of |cells|
  float last_step;           ///< one more can be read
  const float* polynomials;  ///< that about 0 cells; [kTerms] each
  int last_polynomial;       ///< on either side; beyond it D is 0, or period
  float period;              ///< cells, twice those of the table; 0: what is beyond has the last step's
};

/// A beam sharpened by Doppler: the weight is taps[at] D(u), u the cells of the row less those of level
/// ground at the output's azimuth: beside_level + away_hz cells_a_hz.
struct SharpenedSum {
  WeighedRows rows;  ///< whole spans
  const float* taps;
  const float* const* beside_level;  ///< [n_rows] (DopplerCells)
  const CellSpan* const* spans;      ///< [n_rows] of those, from bin 0 on
  const float* away_hz;              ///< [n_rows][kOutputs] of a row from an output, on the level
  const float* cells_a_hz;           ///< of level ground
  const CellSpan* level;             ///< of those
  DopplerTable table;
};
OBLIQ_KERNEL(void, sharpened_sum, const SharpenedSum&);

}  // namespace obliq
