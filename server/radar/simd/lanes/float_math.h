#pragma once
// What exact_math.h has in doubles, to the seven digits of floats. Polynomials are minimax fits.
#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq {

#if defined(OBLIQ_ISA)

using i32x8 = Lanes<std::int32_t, kLanes>;

/// sincos_turns of |turns| <= 1/2 in floats. Error below 3e-7.
OBLIQ_INLINE SinCosOf<f32x8> sincos_of_fraction(f32x8 turns) {
  const f32x8 shifted = 4.0F * turns + kNoFraction;
  const f32x8 x = 6.28318531F * (turns - 0.25F * (shifted - kNoFraction));
  const f32x8 z = x * x;
  const f32x8 s = x + x * z * (-0.166666507F + z * (0.00833197866F - z * 0.000194956362F));
  const f32x8 c = 1.0F + z * (-0.499998948F + z * (0.0416562946F - z * 0.00135978231F));
  const i32x8 quarter = OBLIQ_ISA::bits_as<std::int32_t>(shifted);
  const auto odd = (quarter & 1) != 0;
  const auto signed_by = [](f32x8 of, i32x8 bit) __attribute__((always_inline)) {
    return OBLIQ_ISA::bits_as<float>(OBLIQ_ISA::bits_as<std::int32_t>(of) ^ ((bit & 2) << 30));
  };
  return {signed_by(select(odd, c, s), quarter), signed_by(select(odd, s, c), quarter + 1)};
}

/// log_of_positive in floats. Absolute error below 2e-7 of the greater of 1 and the result.
OBLIQ_INLINE f32x8 log_of_positive(f32x8 x) {
  const i32x8 bits = OBLIQ_ISA::bits_as<std::int32_t>(x);
  const f32x8 m = OBLIQ_ISA::bits_as<float>((bits & 0x007fffff) | 0x3f800000);
  const auto high = m > 1.41421356F;
  const f32x8 mantissa = select(high, 0.5F * m, m);
  const f32x8 exponent =
      select(high, converted<float>((bits >> 23) - 126), converted<float>((bits >> 23) - 127));
  const f32x8 s = (mantissa - 1.0F) / (mantissa + 1.0F);
  const f32x8 z = s * s;
  return 2.0F * s * (1.0F + z * (0.333267138F + z * 0.206437361F)) + exponent * 0.693147181F;
}

/// The square of a random phasor's modulus, of mean 1 (uniform_of_hash).
OBLIQ_INLINE f64x8 modulus2_of_hash(u64x8 hash) {
  return converted<double>(max(-log_of_positive(converted<float>(uniform_of_hash(hash))), f32x8{}));
}

/// Stores a voltage: sqrt(power), at a phase in turns.
OBLIQ_INLINE void store_voltage(f64x8 power, f64x8 turns, double* re, double* im) {
  const auto at = sincos_of_fraction(converted<float>(turns - nearest_integer(turns)));
  const f32x8 amplitude = converted<float>(sqrt(power));
  store(re, converted<double>(amplitude * at.cos));
  store(im, converted<double>(amplitude * at.sin));
}

#endif

}  // namespace obliq
