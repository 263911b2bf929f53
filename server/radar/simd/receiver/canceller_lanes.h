#pragma once
// What a canceller of an antenna that does not turn leaves of echoes that stand still, and of those that move
// by themselves.
#if defined(OBLIQ_ISA)
#include "server/radar/simd/lanes/complex_lanes.h"
#endif

namespace obliq {

/// Echoes that move by themselves: what a canceller leaves of their power, sum of a[k] cos(k turns), k from 0
/// to 3.
struct MovingEchoes {
  float still;      ///< all of the a[k] together
  float turned[3];  ///< those from k = 1 on
};

}  // namespace obliq

#if defined(OBLIQ_ISA)

namespace obliq::OBLIQ_ISA {

/// Of still ones, by a sine of half their turns, as at the middle of the canceller's pulses: (2 sin)^c.
OBLIQ_INLINE f32x16 still_weight(f32x16 sine, int delays) {
  const f32x16 once = 2.0F * sine;
  f32x16 weight = once;
  for (int k = 1; k < delays; ++k) weight = weight * once;
  return weight;
}

/// Of moving ones their power.
OBLIQ_INLINE f32x16 residue_of(const MovingEchoes& echoes, f32x16 sine) {
  // cos k x = 1 - 2 sin^2(k x / 2): small differences of like numbers stay small.
  const f32x16 s2 = sine * sine;
  const f32x16 of_three = 3.0F - 4.0F * s2;
  const f32x16 fall =
      echoes.turned[0] + 4.0F * echoes.turned[1] * (1.0F - s2) + echoes.turned[2] * (of_three * of_three);
  return max(f32x16{}, echoes.still - 2.0F * (s2 * fall));
}

/// What a weight of square `square` is multiplied by, so that a power becomes another; 0 of no power.
OBLIQ_INLINE f32x16 scale_to(f32x16 square, f32x16 from, f32x16 to) {
  const auto has_power = from > 0.0F;
  const f32x16 wanted = select(has_power, to / select(has_power, from, all_lanes(1.0F)), f32x16{});
  return sqrt(wanted / select(square > 0.0F, square, all_lanes(1.0F)));
}
/// A weight of the same sign or phase, by which a power becomes another.
OBLIQ_INLINE f32x16 weight_to(f32x16 weight, f32x16 from, f32x16 to) {
  const f32x16 square = weight * weight;
  return select(square > 0.0F, weight, all_lanes(1.0F)) * scale_to(square, from, to);
}
OBLIQ_INLINE ComplexLanes weight_to(ComplexLanes weight, f32x16 from, f32x16 to) {
  const f32x16 square = power_of(weight);
  const f32x16 scale = scale_to(square, from, to);
  const auto has_phase = square > 0.0F;
  return {select(has_phase, weight.re, all_lanes(1.0F)) * scale,
          select(has_phase, weight.im, f32x16{}) * scale};
}

}  // namespace obliq::OBLIQ_ISA

#endif
