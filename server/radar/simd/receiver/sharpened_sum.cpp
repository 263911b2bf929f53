#include "server/radar/simd/receiver/sharpened_sum.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr int kOutputs = WeighedRows::kOutputs;
constexpr unsigned kAllOutputs = (1U << kOutputs) - 1;
constexpr float kPolynomialsACell = DopplerTable::kPolynomialsACell;
using Outputs = Lanes<float, kOutputs>;

template <int n>
OBLIQ_INLINE Lanes<float, n> magnitude(Lanes<float, n> x) {
  return max(x, -x);
}
/// The nearest whole number, of those below 2^22.
template <int n>
OBLIQ_INLINE Lanes<float, n> rounded(Lanes<float, n> x) {
  return (x + kNoFraction) - kNoFraction;
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
  bool dark;  ///< D is 0 for all

  OBLIQ_INLINE void find(const DopplerTable& table, CellSpan of_row, CellSpan level, const float* away_hz) {
    const Outputs away = load_as<Outputs>(away_hz);
    const Outputs centre = of_row.middle + away * level.middle;
    const Outputs reach = of_row.reach + magnitude(away) * level.reach;
    const Outputs number = rounded(centre * kPolynomialsACell);
    const Outputs cells = number * (1 / kPolynomialsACell);
    found = movemask(reach + magnitude(centre - cells) < 0.25F);
    const Outputs last =
        every(static_cast<const Outputs*>(nullptr), static_cast<float>(table.last_polynomial + 1));
    dark = found == kAllOutputs && !(table.period > 0) && !any(magnitude(number) < last);
    const Outputs known = min(max(within_period(number, kPolynomialsACell * table.period), -last), last);
    to_memory(at, truncated(known * static_cast<float>(DopplerTable::kTerms)));
    to_memory(middle, cells);
  }
};

OBLIQ_INLINE f32x16 polynomial(const float* a, f32x16 x) {
  return a[0] + x * (a[1] + x * (a[2] + x * (a[3] + x * a[4])));
}

/// from[at] and from[at + 1], each pair by one load.
OBLIQ_INLINE Pairs<f32x16> gather_pairs(const float* from, i32x16 at) {
  std::int32_t places[kFloatLanes];
  to_memory(places, at);
  const auto four = [&](int lane) __attribute__((always_inline)) {
    const auto pair = [&](int k) __attribute__((always_inline)) {
      return reinterpret_cast<const __m64*>(from + places[lane + k]);
    };
    const __m128 a = _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), pair(0)), pair(1));
    const __m128 b = _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), pair(2)), pair(3));
    const auto lanes = [](__m128 floats) __attribute__((always_inline)) {
      return OBLIQ_ISA::lanes_from<Lanes<float, 4>>(floats);
    };
    return Pairs<Lanes<float, 4>>{lanes(_mm_shuffle_ps(a, b, 0x88)), lanes(_mm_shuffle_ps(a, b, 0xdd))};
  };
  const auto a = four(0), b = four(4), c = four(8), d = four(12);
  return {joined(joined(a.first, b.first), joined(c.first, d.first)),
          joined(joined(a.second, b.second), joined(c.second, d.second))};
}

/// D of bins that lie far from each other.
OBLIQ_INLINE f32x16 from_steps(const DopplerTable& table, f32x16 cells) {
  const f32x16 step =
      min(magnitude(within_period(cells, table.period)) * static_cast<float>(DopplerTable::kStepsACell),
          all_lanes(table.last_step));
  const i32x16 at = truncated(step);
  const Pairs<f32x16> beside = gather_pairs(table.steps, at);
  return beside.first + (step - floats_of(at)) * (beside.second - beside.first);
}

/// What is summed in one place of the rows: D of a row for an output.
struct Place {
  const SharpenedSum& sum;
  int x;
  f32x16 cells_a_hz;

  OBLIQ_INLINE f32x16 by_polynomial(const Nearest& nearest, f32x16 beside_level, const float* away_hz,
                                    int o) const {
    const f32x16 cells = beside_level + (away_hz[o] * cells_a_hz - nearest.middle[o]);
    return polynomial(sum.table.polynomials + nearest.at[o], cells);
  }
  OBLIQ_INLINE f32x16 by_steps(f32x16 beside_level, const float* away_hz, int o) const {
    return from_steps(sum.table, beside_level + away_hz[o] * cells_a_hz);
  }
};

using Responses = float[kOutputs][kFloatLanes];

/// D where not all outputs have found a polynomial.
OBLIQ_INLINE void find_responses(const Place& place, const Nearest& nearest, f32x16 beside_level,
                                 const float* away_hz, Responses& responses) {
  for (int o = 0; o < kOutputs; ++o)
    store(responses[o], (nearest.found >> o & 1) != 0 ? place.by_polynomial(nearest, beside_level, away_hz, o)
                                                      : place.by_steps(beside_level, away_hz, o));
}

}  // namespace

void sharpened_sum(const SharpenedSum& sum) {
  constexpr int kBlock = 16;
  constexpr int kSpansAhead = 8;  // a line of memory
  const WeighedRows& rows = sum.rows;
  Nearest block[kBlock];
  Responses responses[kBlock];
  for (int x = rows.first; x < rows.first + rows.n; x += kFloatLanes) {
    Totals totals;
    const int tile = x / CellSpan::kBins;
    const Place place{sum, x, load_floats(sum.cells_a_hz + x)};
    for (int begin = 0; begin < rows.n_rows; begin += kBlock) {
      const int end = begin + kBlock < rows.n_rows ? begin + kBlock : rows.n_rows;
      for (int k = begin; k < end; ++k) {
        const float* const away_hz = sum.away_hz + kOutputs * k;
        Nearest& nearest = block[k - begin];
        __builtin_prefetch(sum.spans[k] + tile + kSpansAhead);
        const f32x16 beside_level = load_row(sum.beside_level, k, x);
        nearest.find(sum.table, sum.spans[k][tile], sum.level[tile], away_hz);
        if (nearest.found != kAllOutputs)
          find_responses(place, nearest, beside_level, away_hz, responses[k - begin]);
      }
      for (int k = begin; k < end; ++k) {
        if (sum.spans[k][tile].reach < 0 || block[k - begin].dark) continue;
        const RowLanes row(rows, k, x);
        const float* const taps = sum.taps + (rows.taps_at[k] - rows.skipped);
        const auto add_all = [&](const auto& response) __attribute__((always_inline)) {
#pragma GCC unroll 8
          for (int o = 0; o < kOutputs; ++o) {
            const f32x16 weight = taps[-o * rows.step] * response(o);
            add(totals, o, row, weight, row.power * (weight * weight));
          }
        };
        const Nearest& nearest = block[k - begin];
        if (nearest.found == kAllOutputs) {
          const f32x16 beside_level = load_floats(sum.beside_level[k] + x);
          const float* const away_hz = sum.away_hz + kOutputs * k;
          add_all([&](int o) __attribute__((always_inline)) {
            return place.by_polynomial(nearest, beside_level, away_hz, o);
          });
        } else {
          add_all([&](int o) __attribute__((always_inline)) { return load_floats(responses[k - begin][o]); });
        }
      }
    }
    totals.store_at(rows, x);
  }
}

}  // namespace obliq::OBLIQ_ISA
