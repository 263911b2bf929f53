#pragma once
// The arithmetic that exact_math.h does on a double and lanes.h on eight of them: Real is either. Always
// inlined, so that files compiled for different instruction sets share no machine code.

namespace obliq {

/// Nearest integer for |x| < 2^51 (ties to even): adding 1.5 x 2^52 leaves no bits behind the point.
template <typename Real>
[[gnu::always_inline]] inline Real nearest_integer(Real x) {
  constexpr double kShift = 6755399441055744.0;
  return (x + kShift) - kShift;
}

/// An angle as a whole number of quarter turns, and the sine and cosine of the rest.
template <typename Real>
struct QuarterTurns {
  Real quarters;
  Real sin;
  Real cos;
};

/// Of 2 pi turns, |turns| < 2^51. The reduction modulo one turn is exact; on what is left, in [-pi/4, pi/4],
/// the Taylor series (remainders 5e-18 and 3e-18).
template <typename Real>
[[gnu::always_inline]] inline QuarterTurns<Real> quarter_turns(Real turns) {
  const Real fraction = turns - nearest_integer(turns);
  const Real quarters = nearest_integer(4.0 * fraction);
  const Real x = 6.283185307179586476925 * (fraction - 0.25 * quarters);
  const Real z = x * x;
  const Real s =
      x + x * z *
              (-1.0 / 6 +
               z * (1.0 / 120 +
                    z * (-1.0 / 5040 +
                         z * (1.0 / 362880 + z * (-1.0 / 39916800 + z * (1.0 / 6227020800.0 +
                                                                         z * (-1.0 / 1307674368000.0)))))));
  const Real c =
      1.0 +
      z * (-0.5 + z * (1.0 / 24 + z * (-1.0 / 720 +
                                       z * (1.0 / 40320 + z * (-1.0 / 3628800 +
                                                               z * (1.0 / 479001600.0 +
                                                                    z * (-1.0 / 87178291200.0 +
                                                                         z * (1.0 / 20922789888000.0))))))));
  return {quarters, s, c};
}

/// ln(mantissa 2^exponent), mantissa from sqrt(1/2) to sqrt(2): ln m = 2 artanh(s), s = (m - 1) / (m + 1),
/// |s| <= 0.1716; the series to s^21 (remainder 4e-19).
template <typename Real>
[[gnu::always_inline]] inline Real log_of_parts(Real mantissa, Real exponent) {
  const Real s = (mantissa - 1.0) / (mantissa + 1.0);
  const Real z = s * s;
  Real sum{};
#pragma GCC unroll 11
  for (int k = 21; k >= 1; k -= 2) sum = sum * z + 1.0 / k;
  return 2.0 * s * sum + exponent * 0.69314718055994530942;
}

}  // namespace obliq
