#include "server/radar/simd/speckle_draw.h"

#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/float_lanes.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {

void draw_speckle(const SpeckleDraw& draw) {
  const u64x8 lane{0, 1, 2, 3, 4, 5, 6, 7};
  for (int k = 0; k < draw.n; k += kLanes) {
    const u64x8 hash = mix_words((lane + (draw.cell + static_cast<std::uint64_t>(k))) ^ draw.key);
    const SinCosOf<f64x8> at = sincos_turns(to_doubles(hash >> 32) * 0x1p-32);
    const f64x8 modulus2 = -log_of_positive((to_doubles(hash & 0xffffffffull) + 0.5) * 0x1p-32);
    halves::f32x8 power;
    __builtin_memcpy(&power, draw.power + k, sizeof power);
    const f64x8 amplitude = sqrt(__builtin_convertvector(power, f64x8) * modulus2);
    const halves::f32x8 re = __builtin_convertvector(amplitude * at.cos, halves::f32x8);
    const halves::f32x8 im = __builtin_convertvector(amplitude * at.sin, halves::f32x8);
    const f32x16 pairs =
        __builtin_shufflevector(re, im, 0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15);
    store(draw.iq + 2 * k, pairs);
  }
}

}  // namespace obliq::OBLIQ_ISA
