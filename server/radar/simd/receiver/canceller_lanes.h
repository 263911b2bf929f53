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

/// Of echoes' power, which share moves, and which stands still. Of heights by power, too, which may be below
/// 0.
struct MovingShare {
  f32x16 moving{}, still{};

  MovingShare() = default;
  OBLIQ_INLINE MovingShare(f32x16 moving_power, f32x16 power) {
    const auto has_power = power != 0.0F;
    const f32x16 share = moving_power / select(has_power, power, all_lanes(1.0F));
    moving = select(has_power, min(share, all_lanes(1.0F)), f32x16{});
    still = 1.0F - moving;
  }
  /// What is left of a power of 1 behind a weight of that square for what stands still.
  OBLIQ_INLINE f32x16 left(f32x16 square, f32x16 residue) const { return still * square + moving * residue; }
};

/// What no weight of echoes is as small as, so that even one of 0 has a phase, and its square.
constexpr float kLeastWeight = 1e-15F;
constexpr float kLeastSquare = 1e-30F;

/// A weight of the same sign or phase whose square is that.
OBLIQ_INLINE f32x16 with_square(f32x16 weight, f32x16 square) {
  weight = weight + kLeastWeight;
  return weight * sqrt(square / max(weight * weight, all_lanes(kLeastSquare)));
}
OBLIQ_INLINE ComplexLanes with_square(ComplexLanes weight, f32x16 square) {
  weight.re = weight.re + kLeastWeight;
  const f32x16 scale = sqrt(square / max(power_of(weight), all_lanes(kLeastSquare)));
  return {weight.re * scale, weight.im * scale};
}

}  // namespace obliq::OBLIQ_ISA

#endif
