#include "server/radar/simd/doppler_sums.h"

#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

OBLIQ_INLINE f64x8 turns_of(const DopplerRow& row, int k) {
  const f64x8 sine = converted<double>(load_as<f32x8>(row.sine + k));
  const f64x8 cosine = sqrt(max(broadcast(0), 1.0 - sine * sine));
  return (row.level_hz * cosine + row.up_hz * sine) * load(row.turns_a_hz + k);
}

struct ComplexLanes {
  f32x16 re, im;
};

OBLIQ_INLINE ComplexLanes times(ComplexLanes a, ComplexLanes b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
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

/// A weight of the same phase, by which a power becomes another.
OBLIQ_INLINE ComplexLanes weight_to(ComplexLanes weight, f32x16 from, f32x16 to) {
  const f32x16 square = power_of(weight);
  const f32x16 wanted = select(from > 0.0F, to / select(from > 0.0F, from, all_lanes(1.0F)), f32x16{});
  const auto has_phase = square > 0.0F;
  const f32x16 scale = sqrt(wanted / select(has_phase, square, all_lanes(1.0F)));
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

}  // namespace

void doppler_cells(const DopplerCells& to) {
  for (int k = 0; k < to.row.n; k += kLanes) to_memory(to.cells + k, converted<float>(turns_of(to.row, k)));
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
    const f32x16 c = load_floats(row.cos + k);
    const ComplexLanes u{2.0F * s * s, 2.0F * s * c};
    ComplexLanes power_of_u = u;
    for (int d = 1; d < row.delays; ++d) power_of_u = times(power_of_u, u);
    const float scale = __builtin_sqrtf(row.over_noise_gain);
    ComplexLanes weight{power_of_u.re * scale, power_of_u.im * scale};
    const f32x16 power = load_floats(row.power + k);
    f32x16 left = power * power_of(weight);
    if (row.moving != nullptr) {
      const f32x16 moving = load_floats(row.moving + k);
      left = (power - moving) * power_of(weight) + moving * residue_of(row.echoes, s);
      weight = weight_to(weight, power, left);
    }
    store(row.out_power + k, left);
    if (row.iq != nullptr) store_iq(row.out_iq + 2 * k, times(load_iq(row.iq + 2 * k), weight));
  }
}

void cancelled_sum(const CancelledSum& sum) {
  const WeighedRows& rows = sum.rows;
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    f32x16 power{};
    ComplexLanes iq{};
    f32x16 output_sin{};
    f32x16 output_cos{};
    if (sum.output_sin != nullptr) {
      output_sin = load_floats(sum.output_sin + x);
      output_cos = load_floats(sum.output_cos + x);
    }
    for (int row = 0; row < rows.n_rows; ++row) {
      f32x16 s = load_floats(sum.sin[row] + x);
      f32x16 c = load_floats(sum.cos[row] + x);
      if (sum.output_sin != nullptr) {
        const f32x16 turned = s * output_cos - c * output_sin;
        c = c * output_cos + s * output_sin;
        s = turned;
      }
      const ComplexLanes u{2.0F * s * s, 2.0F * s * c};
      const float* const taps = sum.taps + 4 * (rows.taps_at[row] - rows.skipped);
      ComplexLanes weight{all_lanes(taps[sum.delays]), f32x16{}};
      for (int p = sum.delays - 1; p >= 0; --p) {
        weight = times(weight, u);
        weight.re += all_lanes(taps[p]);
      }
      const f32x16 own = load_floats(rows.power[row] + x);
      f32x16 left = own * power_of(weight);
      if (sum.moving != nullptr) {
        const f32x16 moving = load_floats(sum.moving[row] + x);
        const float tap = sum.power_taps[rows.taps_at[row] - rows.skipped];
        left = (own - moving) * power_of(weight) + moving * (tap * residue_of(sum.echoes, s));
        weight = weight_to(weight, own, left);
      }
      power += left;
      if (rows.iq == nullptr) continue;
      const ComplexLanes more = times(load_iq(rows.iq[row] + 2 * x), weight);
      iq.re += more.re;
      iq.im += more.im;
    }
    store(rows.out_power + x, power);
    if (rows.iq != nullptr) store_iq(rows.out_iq + 2 * x, iq);
  }
}

void sharpened_sum(const SharpenedSum& sum) {
  const WeighedRows& rows = sum.rows;
  const float over_period = sum.period > 0 ? 1 / sum.period : 0;
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    f32x16 power{};
    ComplexLanes iq{};
    const f32x16 output = load_floats(sum.output_cells + x);
    for (int row = 0; row < rows.n_rows; ++row) {
      f32x16 cells = load_floats(sum.cells[row] + x) - output;
      f32x16 tap = all_lanes(sum.taps[rows.taps_at[row] - rows.skipped]);
      if (over_period > 0) {
        // The nearest whole number of periods; half of it says whether it is odd.
        constexpr float kShift = 12582912.0F;  // 1.5 x 2^23
        const f32x16 periods = (cells * over_period + kShift) - kShift;
        cells -= periods * sum.period;
        if (sum.alternates) {
          const f32x16 half = 0.5F * periods;
          const f32x16 whole = (half + kShift) - kShift;
          tap = tap * (1.0F - 4.0F * max(half - whole, whole - half));
        }
      }
      const f32x16 step = min(max(cells, f32x16{} - cells) * sum.steps_a_cell, all_lanes(sum.last_step));
      const i32x16 at = truncated(step);
      const f32x16 low = gather(sum.table, at);
      const f32x16 weight = tap * (low + (step - floats_of(at)) * (gather(sum.table + 1, at) - low));
      power += load_floats(rows.power[row] + x) * (weight * weight);
      if (rows.iq == nullptr) continue;
      const ComplexLanes own = load_iq(rows.iq[row] + 2 * x);
      iq.re += own.re * weight;
      iq.im += own.im * weight;
    }
    store(rows.out_power + x, power);
    if (rows.iq != nullptr) store_iq(rows.out_iq + 2 * x, iq);
  }
}

}  // namespace obliq::OBLIQ_ISA
