#include "server/radar/simd/doppler_sums.h"

#include "server/radar/simd/complex_lanes.h"
#include "server/radar/simd/exact_math.h"

namespace obliq::OBLIQ_ISA {
namespace {

OBLIQ_INLINE f64x8 turns_of(const DopplerRow& row, int k) {
  const f64x8 sine = converted<double>(load_as<f32x8>(row.sine + k));
  const f64x8 cosine = sqrt(max(broadcast(0), 1.0 - sine * sine));
  return (row.level_hz * cosine + row.up_hz * sine) * load(row.turns_a_hz + k);
}

OBLIQ_INLINE f32x16 power_of(ComplexLanes v) { return v.re * v.re + v.im * v.im; }

/// Of a sine of half the turns.
OBLIQ_INLINE f32x16 residue_of(const MovingEchoes& echoes, f32x16 sine) {
  // cos k x = 1 - 2 sin^2(k x / 2): small differences of like numbers stay small.
  const f32x16 s2 = sine * sine;
  const f32x16 of_three = 3.0F - 4.0F * s2;
  const f32x16 fall =
      echoes.turned[0] + 4.0F * echoes.turned[1] * (1.0F - s2) + echoes.turned[2] * (of_three * of_three);
  return max(f32x16{}, echoes.still - 2.0F * (s2 * fall));
}

OBLIQ_INLINE f32x16 powered(f32x16 x, int n) {
  f32x16 y = x;
  for (int k = 1; k < n; ++k) y = y * x;
  return y;
}

/// What a weight of square `square` is multiplied by, so that a power becomes another; 0 of no power.
OBLIQ_INLINE f32x16 scale_to(f32x16 square, f32x16 from, f32x16 to) {
  const auto has_power = from > 0.0F;
  const f32x16 wanted = select(has_power, to / select(has_power, from, all_lanes(1.0F)), f32x16{});
  return sqrt(wanted / select(square > 0.0F, square, all_lanes(1.0F)));
}
/// A weight of the same sign or phase, by which a power becomes another.
OBLIQ_INLINE f32x16 weight_to(f32x16 weight, f32x16 from, f32x16 to) {
  const f32x16 square = weight * weight;
  return select(square > 0.0F, weight, all_lanes(1.0F)) * scale_to(square, from, to);
}
OBLIQ_INLINE ComplexLanes weight_to(ComplexLanes weight, f32x16 from, f32x16 to) {
  const f32x16 square = power_of(weight);
  const f32x16 scale = scale_to(square, from, to);
  const auto has_phase = square > 0.0F;
  return {select(has_phase, weight.re, all_lanes(1.0F)) * scale,
          select(has_phase, weight.im, f32x16{}) * scale};
}

/// Real and imaginary parts of 16 bins.
OBLIQ_INLINE ComplexLanes load_iq(const float* iq) {
  float re[kFloatLanes], im[kFloatLanes];
  for (int l = 0; l < kFloatLanes; ++l) {
    re[l] = iq[2 * l];
    im[l] = iq[2 * l + 1];
  }
  return {load_floats(re), load_floats(im)};
}
OBLIQ_INLINE void store_iq(float* iq, ComplexLanes v) {
  float re[kFloatLanes], im[kFloatLanes];
  store(re, v.re);
  store(im, v.im);
  for (int l = 0; l < kFloatLanes; ++l) {
    iq[2 * l] = re[l];
    iq[2 * l + 1] = im[l];
  }
}

/// |cells| within the first half of the period.
OBLIQ_INLINE f32x16 folded(const SharpenedSum& sum, f32x16 cells) {
  cells = max(cells, f32x16{} - cells);
  if (sum.period > 0 && any(cells > 0.5F * sum.period)) {
    constexpr float kShift = 12582912.0F;  // 1.5 x 2^23: the nearest whole number of periods
    cells -= ((cells * (1 / sum.period) + kShift) - kShift) * sum.period;
    cells = max(cells, f32x16{} - cells);
  }
  return cells;
}

/// D of 16 neighbouring bins. Most lie near each other: within a quarter of a cell of one of a few
/// polynomials.
OBLIQ_INLINE f32x16 response_at(const SharpenedSum& sum, f32x16 signed_cells) {
  const f32x16 cells = folded(sum, signed_cells);
  const float middle = cells[kFloatLanes / 2];
  const int k = static_cast<int>(middle * DopplerTable::kPolynomialsACell + 0.5F);
  const f32x16 beside = cells - static_cast<float>(k) * (1.0F / DopplerTable::kPolynomialsACell);
  if (k <= sum.table.last_polynomial && !any(beside * beside > 1.0F / 16)) {
    const float* const a = sum.table.polynomials + DopplerTable::kTerms * k;
    return a[0] + beside * (a[1] + beside * (a[2] + beside * (a[3] + beside * a[4])));
  }
  const f32x16 step =
      min(cells * static_cast<float>(DopplerTable::kStepsACell), all_lanes(sum.table.last_step));
  const i32x16 at = truncated(step);
  const f32x16 low = gather(sum.table.steps, at);
  return low + (step - floats_of(at)) * (gather(sum.table.steps + 1, at) - low);
}

}  // namespace

void doppler_cells(const DopplerCells& to) {
  for (int k = 0; k < to.row.n; k += kLanes) to_memory(to.cells + k, converted<float>(turns_of(to.row, k)));
}

void doppler_turns(const DopplerTurns& to) {
  for (int k = 0; k < to.row.n; k += kLanes) to_memory(to.turns + k, turns_of(to.row, k));
}

void doppler_phasors(const DopplerPhasors& to) {
  for (int k = 0; k < to.row.n; k += kLanes) {
    const SinCosOf<f64x8> half = sincos_turns(0.5 * turns_of(to.row, k));
    to_memory(to.sin + k, converted<float>(half.sin));
    to_memory(to.cos + k, converted<float>(half.cos));
  }
}

void cancel_row(const CancelledRow& row) {
  for (int k = 0; k < row.n; k += kFloatLanes) {
    const f32x16 s = load_floats(row.sin + k);
    const f32x16 power = load_floats(row.power + k);
    f32x16 weight = powered(2.0F * s, row.delays) * row.over_noise_root;
    f32x16 left = power * (weight * weight);
    if (row.moving != nullptr) {
      const f32x16 moving = load_floats(row.moving + k);
      left = (power - moving) * (weight * weight) + moving * residue_of(row.echoes, s);
      weight = weight_to(weight, power, left);
    }
    store(row.out_power + k, left);
    if (row.iq == nullptr) continue;
    const ComplexLanes iq = load_iq(row.iq + 2 * k);
    store_iq(row.out_iq + 2 * k, {iq.re * weight, iq.im * weight});
  }
}

namespace {

constexpr int kOutputs = WeighedRows::kOutputs;

/// What outputs are summed up to, in one place of their rows.
struct Totals {
  f32x16 power[kOutputs] = {};
  ComplexLanes iq[kOutputs] = {};

  OBLIQ_INLINE void store_at(const WeighedRows& rows, int x) const {
    for (int o = 0; o < kOutputs; ++o) {
      store(rows.out_power[o] + x, power[o]);
      if (rows.re != nullptr) store_iq(rows.out_iq[o] + 2 * x, iq[o]);
    }
  }
};

struct RowLanes {
  f32x16 power, moving;
  ComplexLanes iq;

  OBLIQ_INLINE RowLanes(const WeighedRows& rows, const float* const* moves, int row, int x)
      : power(load_floats(rows.power[row] + x)), moving{}, iq{} {
    if (moves != nullptr) moving = load_floats(moves[row] + x);
    if (rows.re != nullptr) iq = {load_floats(rows.re[row] + x), load_floats(rows.im[row] + x)};
  }
};

OBLIQ_INLINE void add(Totals& totals, int o, const RowLanes& row, f32x16 weight, f32x16 power) {
  totals.power[o] += power;
  totals.iq[o].re += row.iq.re * weight;
  totals.iq[o].im += row.iq.im * weight;
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
      const RowLanes row(rows, sum.moving, k, x);
      const f32x16 row_sin = load_floats(sum.sin[k] + x);
      const f32x16 row_cos = load_floats(sum.cos[k] + x);
      std::int32_t at = rows.taps_at[k] - rows.skipped;
#pragma GCC unroll 4
      for (int o = 0; o < kOutputs; ++o, at -= rows.step) {
        const f32x16 s = row_sin * output_cos[o] - row_cos * output_sin[o];
        f32x16 weight = powered(2.0F * s, sum.delays) * (sum.taps[at] * sum.over_noise_root);
        f32x16 left = row.power * (weight * weight);
        if (sum.moving != nullptr) {
          left = (row.power - row.moving) * (weight * weight) +
                 row.moving * (sum.power_taps[at] * residue_of(sum.echoes, s));
          weight = weight_to(weight, row.power, left);
        }
        add(totals, o, row, weight, left);
      }
    }
    totals.store_at(rows, x);
  }
}

void cancelled_sum(const CancelledSum& sum) {
  const WeighedRows& rows = sum.rows;
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    Totals totals;
    f32x16 output_sin[kOutputs] = {}, output_cos[kOutputs];
    for (int o = 0; o < kOutputs; ++o) {
      output_cos[o] = all_lanes(1.0F);
      if (sum.output_sin[o] == nullptr) continue;
      output_sin[o] = load_floats(sum.output_sin[o] + x);
      output_cos[o] = load_floats(sum.output_cos[o] + x);
    }
    for (int k = 0; k < rows.n_rows; ++k) {
      const RowLanes row(rows, sum.moving, k, x);
      const f32x16 row_sin = load_floats(sum.sin[k] + x);
      const f32x16 row_cos = load_floats(sum.cos[k] + x);
      std::int32_t at = rows.taps_at[k] - rows.skipped;
      for (int o = 0; o < kOutputs; ++o, at -= rows.step) {
        const f32x16 s = row_sin * output_cos[o] - row_cos * output_sin[o];
        const f32x16 c = row_cos * output_cos[o] + row_sin * output_sin[o];
        const ComplexLanes u{2.0F * (s * s), 2.0F * (s * c)};
        const float* const taps = sum.taps + std::ptrdiff_t{4} * at;
        ComplexLanes weight{all_lanes(taps[sum.delays]), f32x16{}};
        for (int p = sum.delays - 1; p >= 0; --p) {
          weight = times(weight, u);
          weight.re += all_lanes(taps[p]);
        }
        f32x16 left = row.power * power_of(weight);
        if (sum.moving != nullptr) {
          left = (row.power - row.moving) * power_of(weight) +
                 row.moving * (sum.power_taps[at] * residue_of(sum.echoes, s));
          weight = weight_to(weight, row.power, left);
        }
        totals.power[o] += left;
        if (rows.re == nullptr) continue;
        for (int p = 0; p < sum.delays; ++p) weight = times(weight, {c, s});
        const ComplexLanes more = times(row.iq, weight);
        totals.iq[o].re += more.re;
        totals.iq[o].im += more.im;
      }
    }
    totals.store_at(rows, x);
  }
}

void sharpened_sum(const SharpenedSum& sum) {
  const WeighedRows& rows = sum.rows;
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    Totals totals;
    f32x16 output[kOutputs];
    for (int o = 0; o < kOutputs; ++o) output[o] = load_floats(sum.output_cells[o] + x);
    for (int k = 0; k < rows.n_rows; ++k) {
      const RowLanes row(rows, nullptr, k, x);
      const f32x16 cells = load_floats(sum.cells[k] + x);
      std::int32_t at = rows.taps_at[k] - rows.skipped;
#pragma GCC unroll 4
      for (int o = 0; o < kOutputs; ++o, at -= rows.step) {
        const float tap = sum.taps[at];
        if (tap == 0) continue;
        const f32x16 weight = tap * response_at(sum, cells - output[o]);
        add(totals, o, row, weight, row.power * (weight * weight));
      }
    }
    totals.store_at(rows, x);
  }
}

}  // namespace obliq::OBLIQ_ISA
