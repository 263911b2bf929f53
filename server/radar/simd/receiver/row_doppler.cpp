#include "server/radar/simd/receiver/row_doppler.h"

#include "server/radar/simd/lanes/exact_math.h"

namespace obliq::OBLIQ_ISA {
namespace {

OBLIQ_INLINE f64x8 cosine_of(f64x8 sine) { return sqrt(max(broadcast(0), 1.0 - sine * sine)); }

OBLIQ_INLINE f64x8 turns_of(const DopplerRow& row, int k) {
  const f64x8 sine = converted<double>(load_as<f32x8>(row.sine + k));
  return (row.level_hz * cosine_of(sine) + row.up_hz * sine) * load(row.turns_a_hz + k);
}

/// Differences first: what is left of them is small.
OBLIQ_INLINE f32x8 beside_level(const DopplerCells& to, int k) {
  const f64x8 sine = converted<double>(load_as<f32x8>(to.row.sine + k));
  const f64x8 level = converted<double>(load_as<f32x8>(to.level_sine + k));
  const f64x8 hz = to.row.level_hz * (cosine_of(sine) - cosine_of(level)) + to.row.up_hz * (sine - level) +
                   (to.row.up_hz - to.level_up_hz) * level;
  return converted<float>(hz * load(to.row.turns_a_hz + k));
}

}  // namespace

void doppler_cells(const DopplerCells& to) {
  constexpr float kFar = 1e30F;
  static_assert(CellSpan::kBins == kFloatLanes);
  for (int k = 0; k < to.row.n; k += kFloatLanes) {
    const f32x16 cells = joined(beside_level(to, k), beside_level(to, k + kLanes));
    store(to.beside_level + k, cells);
    const auto lit = load_floats(to.power + k) > 0.0F;
    const float low = least_of(select(lit, cells, all_lanes(kFar)));
    const float high = greatest_of(select(lit, cells, all_lanes(-kFar)));
    to.spans[k / kFloatLanes] =
        low > high ? CellSpan{0, -1} : CellSpan{0.5F * (low + high), 0.5F * (high - low)};
  }
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
    f32x16 weight = still_weight(s, row.delays) * row.over_noise_root;
    f32x16 left = weight * weight;
    if (row.moving != nullptr) {
      left = MovingShare(load_floats(row.moving + k), power).left(left, residue_of(row.echoes, s));
      weight = with_square(weight, left);
    }
    store(row.out_power + k, power * left);
    if (row.iq == nullptr) continue;
    const ComplexLanes iq = load_iq(row.iq + 2 * k);
    store_iq(row.out_iq + 2 * k, {iq.re * weight, iq.im * weight});
  }
}

}  // namespace obliq::OBLIQ_ISA
