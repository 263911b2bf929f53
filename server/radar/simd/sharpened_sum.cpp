#include "server/radar/simd/sharpened_sum.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr int kOutputs = WeighedRows::kOutputs;
constexpr float kPolynomialsACell = DopplerTable::kPolynomialsACell;
using Outputs = Lanes<float, kOutputs>;

template <int n>
OBLIQ_INLINE Lanes<float, n> magnitude(Lanes<float, n> x) {
  return max(x, -x);
}
/// The nearest whole number, of those below 2^22.
template <int n>
OBLIQ_INLINE Lanes<float, n> rounded(Lanes<float, n> x) {
  constexpr float kShift = 12582912.0F;  // 1.5 x 2^23
  return (x + kShift) - kShift;
}
/// Less whole periods.
template <int n>
OBLIQ_INLINE Lanes<float, n> within_period(Lanes<float, n> x, float period) {
  return period > 0 ? x - rounded(x * (1 / period)) * period : x;
}

/// Which polynomial of D has all of a tile's bins that have power, for each output: where in the table it
/// stands, its middle in cells; and for which outputs one has.
struct Nearest {
  std::int32_t at[kOutputs];
  float middle[kOutputs];
  unsigned found;

  OBLIQ_INLINE Nearest(const DopplerTable& table, CellSpan of_row, CellSpan level, Outputs away_hz) {
    const Outputs centre = of_row.middle + away_hz * level.middle;
    const Outputs reach = of_row.reach + magnitude(away_hz) * level.reach;
    const Outputs number = rounded(centre * kPolynomialsACell);
    const Outputs cells = number * (1 / kPolynomialsACell);
    found = movemask(reach + magnitude(centre - cells) < 0.25F);
    const Outputs last =
        every(static_cast<const Outputs*>(nullptr), static_cast<float>(table.last_polynomial + 1));
    const Outputs known = min(max(within_period(number, kPolynomialsACell * table.period), -last), last);
    to_memory(at, truncated(known * static_cast<float>(DopplerTable::kTerms)));
    to_memory(middle, cells);
  }
};

OBLIQ_INLINE f32x16 polynomial(const float* a, f32x16 x) {
  return a[0] + x * (a[1] + x * (a[2] + x * (a[3] + x * a[4])));
}

/// D of bins that lie far from each other.
OBLIQ_INLINE f32x16 from_steps(const DopplerTable& table, f32x16 cells) {
  const f32x16 step =
      min(magnitude(within_period(cells, table.period)) * static_cast<float>(DopplerTable::kStepsACell),
          all_lanes(table.last_step));
  const i32x16 at = truncated(step);
  const f32x16 low = gather(table.steps, at);
  return low + (step - floats_of(at)) * (gather(table.steps + 1, at) - low);
}

}  // namespace

void sharpened_sum(const SharpenedSum& sum) {
  const WeighedRows& rows = sum.rows;
  constexpr unsigned kAll = (1U << kOutputs) - 1;
  const Outputs output_hz = load_as<Outputs>(sum.output_hz);
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    Totals totals;
    const int tile = x / CellSpan::kBins;
    const f32x16 cells_a_hz = load_floats(sum.cells_a_hz + x);
    f32x16 output_cells[kOutputs];
    for (int o = 0; o < kOutputs; ++o) output_cells[o] = sum.output_hz[o] * cells_a_hz;
    for (int k = 0; k < rows.n_rows; ++k) {
      const CellSpan span = sum.spans[k][tile];
      if (span.reach < 0) continue;
      const RowLanes row(rows, nullptr, k, x);
      const f32x16 cells = load_row(sum.beside_level, k, x) + sum.row_hz[k] * cells_a_hz;
      const Nearest nearest(sum.table, span, sum.level[tile], sum.row_hz[k] - output_hz);
      const float* const taps = sum.taps + (rows.taps_at[k] - rows.skipped);
      const auto by_polynomial = [&](int o) __attribute__((always_inline)) {
        return polynomial(sum.table.polynomials + nearest.at[o],
                          cells - (output_cells[o] + nearest.middle[o]));
      };
      const auto add_all = [&](const auto& response) __attribute__((always_inline)) {
#pragma GCC unroll 8
        for (int o = 0; o < kOutputs; ++o) {
          const f32x16 weight = taps[-o * rows.step] * response(o);
          add(totals, o, row, weight, row.power * (weight * weight));
        }
      };
      if (nearest.found == kAll) {
        add_all(by_polynomial);
        continue;
      }
      float responses[kOutputs][kFloatLanes];
      for (int o = 0; o < kOutputs; ++o)
        store(responses[o], (nearest.found >> o & 1) != 0 ? by_polynomial(o)
                                                          : from_steps(sum.table, cells - output_cells[o]));
      add_all([&](int o) __attribute__((always_inline)) { return load_floats(responses[o]); });
    }
    totals.store_at(rows, x);
  }
}

}  // namespace obliq::OBLIQ_ISA
