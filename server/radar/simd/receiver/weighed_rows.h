#pragma once
// Sums over rows of sharp bins in which each bin has a weight of its own.
#include <cstdint>
#if defined(OBLIQ_ISA)
#include "server/radar/simd/lanes/complex_lanes.h"
#endif

namespace obliq {

/// Rows of which neighbouring outputs are sums, each with a weight of its own in each bin.
struct WeighedRows {
  static constexpr int kOutputs = 8;
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

}  // namespace obliq

#if defined(OBLIQ_ISA)

namespace obliq::OBLIQ_ISA {

/// What outputs are summed up to, in one place of their rows.
struct Totals {
  f32x16 power[WeighedRows::kOutputs] = {};
  ComplexLanes iq[WeighedRows::kOutputs] = {};

  OBLIQ_INLINE void store_at(const WeighedRows& rows, int x) const {
    for (int o = 0; o < WeighedRows::kOutputs; ++o) {
      store(rows.out_power[o] + x, power[o]);
      if (rows.re != nullptr) store_iq(rows.out_iq[o] + 2 * x, iq[o]);
    }
  }
};

/// Rows are far apart in memory: what the next tiles will read is asked for.
OBLIQ_INLINE f32x16 load_row(const float* const* rows, int row, int x) {
  constexpr int kAhead = 2 * kFloatLanes;
  const float* const from = rows[row] + x;
  __builtin_prefetch(from + kAhead);
  return load_floats(from);
}

struct RowLanes {
  f32x16 power;
  ComplexLanes iq;

  OBLIQ_INLINE RowLanes(const WeighedRows& rows, int row, int x) : power(load_row(rows.power, row, x)), iq{} {
    if (rows.re != nullptr) iq = {load_row(rows.re, row, x), load_row(rows.im, row, x)};
  }
};

/// Of a real weight, with the power behind it.
OBLIQ_INLINE void add(Totals& totals, int o, const RowLanes& row, f32x16 weight, f32x16 power) {
  totals.power[o] += power;
  totals.iq[o].re += row.iq.re * weight;
  totals.iq[o].im += row.iq.im * weight;
}

}  // namespace obliq::OBLIQ_ISA

#endif
