#include "server/radar/simd/white_noise.h"

#include "server/radar/simd/exact_math.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {

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

}  // namespace obliq::OBLIQ_ISA
