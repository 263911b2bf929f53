// The filters of beam and pulse: sums over rows and along them, in the order of the taps in every lane.
#include "server/radar/simd/echo_filters.h"

#include "server/radar/simd/float_lanes.h"

namespace obliq::OBLIQ_ISA {

void azimuth_sum(const AzimuthSum& sum) {
  constexpr int kOutputs = AzimuthSum::kOutputs;
  constexpr int kAhead = 2 * kFloatLanes;  // rows are far apart: their next lines are asked for
  for (int x = sum.first; x < sum.first + sum.n; x += kFloatLanes) {
    f32x16 total[kOutputs] = {};
    for (int row = 0; row < sum.n_rows; ++row) {
      const float* const from = sum.rows[row] + x;
      __builtin_prefetch(from + kAhead);
      const f32x16 here = load_floats(from);
      const float* const taps = sum.taps + (sum.taps_at[row] - sum.skipped);
#pragma GCC unroll 4
      for (int o = 0; o < kOutputs; ++o) total[o] += taps[-o * sum.step] * here;
    }
#pragma GCC unroll 4
    for (int o = 0; o < kOutputs; ++o) store(sum.out[o] + x, total[o]);
  }
}

void range_sum(const RangeSum& sum) {
  constexpr int kBlocks = 4;
  int x = 0;
  for (; x + kBlocks * kFloatLanes <= sum.n; x += kBlocks * kFloatLanes) {
    f32x16 total[kBlocks] = {};
    const float* from = sum.in + x;
    for (int j = 0; j < sum.n_taps; ++j, from += sum.stride)
#pragma GCC unroll 4
      for (int b = 0; b < kBlocks; ++b) total[b] += sum.taps[j] * load_floats(from + b * kFloatLanes);
#pragma GCC unroll 4
    for (int b = 0; b < kBlocks; ++b) store(sum.out + x + b * kFloatLanes, total[b]);
  }
  for (; x < sum.n; x += kFloatLanes) {
    f32x16 total{};
    for (int j = 0; j < sum.n_taps; ++j) total += sum.taps[j] * load_floats(sum.in + x + j * sum.stride);
    store(sum.out + x, total);
  }
}

}  // namespace obliq::OBLIQ_ISA
