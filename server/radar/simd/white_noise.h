#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// A run of independent complex Gaussian numbers of mean square 1: number k follows from the key and cell + k
/// alone. The arrays are written up to a multiple of 8.
struct NoiseRun {
  std::uint64_t key;
  std::uint64_t cell;
  int n;
  double* re;
  double* im;
};

/// The same bits whatever the instruction set.
OBLIQ_KERNEL(void, white_noise, const NoiseRun&);

/// A row under a filter: out[m] += sum of taps[j] in[m + j], j from 0 to n_taps - 1.
struct FilteredRow {
  int n;
  int n_taps;
  const double* taps;
  const double* in;  ///< read up to a multiple of 8 beyond n + n_taps
  double* out;       ///< read and written up to a multiple of 8
};
OBLIQ_KERNEL(void, filter_row, const FilteredRow&);

}  // namespace obliq
