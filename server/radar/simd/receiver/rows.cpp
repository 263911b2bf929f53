#include "server/radar/simd/receiver/rows.h"

#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/simd/lanes/float_lanes.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {

// The filters of beam and pulse: sums over rows and along them, in the order of the taps in every lane.

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

void draw_speckle(const SpeckleDraw& draw) {
  const u64x8 lane = lane_numbers<std::uint64_t, kLanes>();
  for (int k = 0; k < draw.n; k += kLanes) {
    const u64x8 hash = mix_words((lane + (draw.cell + static_cast<std::uint64_t>(k))) ^ draw.key);
    const SinCosOf<f64x8> at = sincos_turns(turns_of_hash(hash));
    const f64x8 modulus2 = -log_of_positive(uniform_of_hash(hash));
    const f64x8 amplitude = sqrt(converted<double>(load_as<Lanes<float, kLanes>>(draw.power + k)) * modulus2);
    float re[kLanes], im[kLanes];
    to_memory(re, converted<float>(amplitude * at.cos));
    to_memory(im, converted<float>(amplitude * at.sin));
    for (int l = 0; l < kLanes; ++l) {
      draw.iq[2 * (k + l)] = re[l];
      draw.iq[2 * (k + l) + 1] = im[l];
    }
  }
}

void white_noise(const NoiseRun& run) {
  const u64x8 lane = lane_numbers<std::uint64_t, kLanes>();
  for (int k = 0; k < run.n; k += kLanes) {
    const u64x8 hash = mix_words(run.key ^ (lane + (run.cell + static_cast<std::uint64_t>(k))));
    const SinCosOf<f64x8> at = sincos_turns(turns_of_hash(hash));
    const f64x8 modulus = sqrt(-log_of_positive(uniform_of_hash(hash)));
    store(run.re + k, modulus * at.cos);
    store(run.im + k, modulus * at.sin);
  }
}

void filter_row(const FilteredRow& row) {
  for (int m = 0; m < row.n; m += kLanes) {
    f64x8 sum = load(row.out + m);
    for (int j = 0; j < row.n_taps; ++j) sum = sum + row.taps[j] * load(row.in + m + j);
    store(row.out + m, sum);
  }
}

namespace {

constexpr double kDb_of_log = 4.3429448190325182765;  // 10 / ln(10)

}  // namespace

void video_levels(const VideoRun& run) {
  for (int k = 0; k < run.n; k += kLanes) {
    const f64x8 power = load(run.power + k);
    const mask8 some = power > 0.0;
    const f64x8 db = kDb_of_log * log_of_positive(max(power, broadcast(0x1p-1022)));
    const f64x8 steps = clamp(run.steps_a_db * (db - run.floor_db), broadcast(0), broadcast(run.most - 1));
    store_i32(run.level + k, select(some, 1.0 + nearest_integer(steps), broadcast(0)));
  }
}

}  // namespace obliq::OBLIQ_ISA
