#include "server/radar/simd/white_noise.h"

#include "server/radar/simd/exact_math.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {

void white_noise(const NoiseRun& run) {
  const u64x8 lane{0, 1, 2, 3, 4, 5, 6, 7};
  for (int k = 0; k < run.n; k += kLanes) {
    const u64x8 hash = mix_words(run.key ^ (lane + (run.cell + static_cast<std::uint64_t>(k))));
    // Box and Muller 1958: |w|^2 = -ln(uniform) is exponential with mean 1.
    const f64x8 uniform = (to_doubles(hash & 0xffffffffull) + 0.5) * 0x1p-32;
    const SinCosOf<f64x8> at = sincos_turns(to_doubles(hash >> 32) * 0x1p-32);
    const f64x8 modulus = sqrt(-log_of_positive(uniform));
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
