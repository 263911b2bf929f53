#pragma once
// Kernels over rows of bins: the sums over beam and pulse, random numbers, video.
#include <cstdint>

#include "server/radar/simd/lanes/kernel.h"

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

/// sqrt(power) times a circular complex Gaussian number of mean square 1, which follows from the key and
/// cell + k alone: |u|^2 = -ln(uniform) (Box and Muller 1958).
struct SpeckleDraw {
  std::uint64_t key;
  std::uint64_t cell;
  int n;
  const float* power;  ///< read up to a multiple of 8
  float* iq;           ///< [n][2]; written up to a multiple of 8
};
OBLIQ_KERNEL(void, draw_speckle, const SpeckleDraw&);

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
/// The same bits whatever the instruction set.
OBLIQ_KERNEL(void, video_levels, const VideoRun&);

}  // namespace obliq
