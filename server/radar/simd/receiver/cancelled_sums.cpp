#include "server/radar/simd/receiver/cancelled_sums.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr int kOutputs = WeighedRows::kOutputs;

/// Sine and cosine of half the turns; of the canceller's response what its even and its odd terms have.
struct HalfTurns {
  f32x16 sin, y, even, odd;

  OBLIQ_INLINE HalfTurns(f32x16 s, f32x16 c, int delays)
      : sin(s),
        y(4.0F * (s * s)),
        even(delays == 2 ? all_lanes(1.0F) : c),
        odd(delays == 2 ? 2.0F * (s * c) : s) {}
};

/// taps: even and odd terms.
template <int delays>
OBLIQ_INLINE ComplexLanes cancelled(const HalfTurns& at, const float* taps) {
  if constexpr (delays == 1) return {taps[0] * at.even, taps[2] * at.odd};
  const f32x16 even = taps[0] + taps[1] * at.y;
  if constexpr (delays == 2) return {even, taps[2] * at.odd};
  return {even * at.even, (taps[2] + taps[3] * at.y) * at.odd};
}

template <int delays, bool locked, bool moves>
OBLIQ_INLINE void cancelled_sum_of(const CancelledSum& sum) {
  const WeighedRows& rows = sum.rows;
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    Totals totals;
    for (int k = 0; k < rows.n_rows; ++k) {
      const RowLanes row(rows, k, x);
      MovingShare share;
      if (sum.moving != nullptr) share = {load_row(sum.moving, k, x), row.power};
      const f32x16 row_sin = load_row(sum.sin, k, x);
      const f32x16 row_cos = load_row(sum.cos, k, x);
      const HalfTurns of_row(row_sin, row_cos, delays);
      std::int32_t at = rows.taps_at[k] - rows.skipped;
#pragma GCC unroll 8
      for (int o = 0; o < kOutputs; ++o, at -= rows.step) {
        HalfTurns turns = of_row;
        if constexpr (locked) {
          const f32x16 output_sin = load_floats(sum.output_sin[o] + x);
          const f32x16 output_cos = load_floats(sum.output_cos[o] + x);
          turns = {row_sin * output_cos - row_cos * output_sin, row_cos * output_cos + row_sin * output_sin,
                   delays};
        }
        ComplexLanes weight = cancelled<delays>(turns, sum.taps + std::ptrdiff_t{4} * at);
        f32x16 left = power_of(weight);
        if constexpr (moves) {
          left = share.left(left, sum.power_taps[at] * residue_of(sum.echoes, turns.sin));
          weight = with_square(weight, left);
        }
        totals.power[o] += row.power * left;
        const ComplexLanes more = times(row.iq, weight);
        totals.iq[o].re += more.re;
        totals.iq[o].im += more.im;
      }
    }
    totals.store_at(rows, x);
  }
}

template <int delays>
void cancelled_sum_after(const CancelledSum& sum) {
  const bool locked = sum.output_sin[0] != nullptr;
  const bool moves = sum.moving != nullptr;
  if (locked && moves) cancelled_sum_of<delays, true, true>(sum);
  if (locked && !moves) cancelled_sum_of<delays, true, false>(sum);
  if (!locked && moves) cancelled_sum_of<delays, false, true>(sum);
  if (!locked && !moves) cancelled_sum_of<delays, false, false>(sum);
}

}  // namespace

void locked_sum(const LockedSum& sum) {
  const WeighedRows& rows = sum.rows;
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    Totals totals;
    f32x16 output_sin[kOutputs], output_cos[kOutputs];
    for (int o = 0; o < kOutputs; ++o) {
      output_sin[o] = load_floats(sum.output_sin[o] + x);
      output_cos[o] = load_floats(sum.output_cos[o] + x);
    }
    for (int k = 0; k < rows.n_rows; ++k) {
      const RowLanes row(rows, k, x);
      MovingShare share;
      if (sum.moving != nullptr) share = {load_row(sum.moving, k, x), row.power};
      const f32x16 row_sin = load_row(sum.sin, k, x);
      const f32x16 row_cos = load_row(sum.cos, k, x);
      std::int32_t at = rows.taps_at[k] - rows.skipped;
#pragma GCC unroll 8
      for (int o = 0; o < kOutputs; ++o, at -= rows.step) {
        const f32x16 s = row_sin * output_cos[o] - row_cos * output_sin[o];
        f32x16 weight = still_weight(s, sum.delays) * (sum.taps[at] * sum.over_noise_root);
        f32x16 left = weight * weight;
        if (sum.moving != nullptr) {
          left = share.left(left, sum.power_taps[at] * residue_of(sum.echoes, s));
          weight = with_square(weight, left);
        }
        add(totals, o, row, weight, row.power * left);
      }
    }
    totals.store_at(rows, x);
  }
}

void cancelled_sum(const CancelledSum& sum) {
  if (sum.delays == 1) cancelled_sum_after<1>(sum);
  if (sum.delays == 2) cancelled_sum_after<2>(sum);
  if (sum.delays == 3) cancelled_sum_after<3>(sum);
}

}  // namespace obliq::OBLIQ_ISA
