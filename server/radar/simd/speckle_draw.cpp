#include "server/radar/simd/speckle_draw.h"

#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/float_lanes.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {

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

}  // namespace obliq::OBLIQ_ISA
