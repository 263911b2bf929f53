#pragma once
// Elementary functions whose bits do not depend on the C library's choice by processor, nor on whether they
// are worked out for one double or for eight. Plain IEEE double operations only (the project is built with
// -ffp-contract=off). tests/unit/radar/simd/hit_lanes_test.cpp measures their errors against the C library in
// long double.
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

template <typename Real>
struct SinCosOf {
  Real sin;
  Real cos;
};
using SinCos = SinCosOf<double>;

/// What a hash of 64 bits gives a random phasor: its angle in turns, from 0, and a uniform number between 0
/// and 1 for its modulus, of which -ln(uniform) is the square with mean 1 (Box and Muller 1958).
template <typename Bits>
OBLIQ_INLINE auto turns_of_hash(Bits hash) {
  return to_doubles(hash >> 32) * 0x1p-32;
}
template <typename Bits>
OBLIQ_INLINE auto uniform_of_hash(Bits hash) {
  return (to_doubles(hash & 0xffffffffull) + 0.5) * 0x1p-32;
}

/// sin and cos of 2 pi turns, |turns| < 2^51. Error below 3e-16: the reduction modulo one turn is exact; on
/// what is left, in [-pi/4, pi/4], the Taylor series (remainders 5e-18 and 3e-18).
template <typename Real>
OBLIQ_INLINE SinCosOf<Real> sincos_turns(Real turns) {
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
  // The quarter's number, from 0, in the low bits: it swaps the two, and sets their signs.
  const auto quarter = as_bits(quarters + 6755399441055744.0);
  const Mask<Real> odd = (quarter & 1) != 0;
  const auto minus_sin = (quarter >> 1) << 63;
  const auto minus_cos = ((quarter + 1) >> 1) << 63;
  return {as_doubles(as_bits(select(odd, c, s)) ^ minus_sin),
          as_doubles(as_bits(select(odd, s, c)) ^ minus_cos)};
}

/// atan2(right, ahead) in (-pi, pi]: the bearing of a point, clockwise from straight ahead; 0 at the origin.
/// Absolute error below 4e-16: two steps of Newton's method from a guess that is off by at most 0.004.
inline double bearing_of(double right, double ahead) {
  const double length = std::sqrt(right * right + ahead * ahead);
  if (!(length > 0)) return 0;
  const double sine = right / length;
  const double cosine = ahead / length;
  const double s = std::fabs(sine);
  const double c = std::fabs(cosine);
  constexpr double half_turn = std::numbers::pi;
  const double tangent = s < c ? s / c : c / s;
  double angle = tangent * (half_turn / 4 + 0.273 * (1 - tangent));
  if (s >= c) angle = half_turn / 2 - angle;
  if (cosine < 0) angle = half_turn - angle;
  if (sine < 0) angle = -angle;
  for (int step = 0; step < 2; ++step) {
    const SinCos at = sincos_turns(angle / (2 * half_turn));
    const double off = sine * at.cos - cosine * at.sin;  // sin of what is missing
    angle += off + off * off * off / 6;
  }
  return angle;
}

/// exp(x) for x <= 0; 0 below -700. Relative error below 4.5e-16.
template <typename Real>
OBLIQ_INLINE Real exp_of_negative(Real x) {
  const auto is_normal = x > -700.0;
  const Real at = select(is_normal, x, broadcast<Real>(-700));
  // x = n ln 2 + r with |r| <= ln 2 / 2; ln 2 in two parts so that n ln 2 is exact to the last bit of r.
  const Real n = nearest_integer(at * 1.4426950408889634074);
  const Real r = (at - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
  Real sum = broadcast<Real>(1.0 / 6227020800.0);
  const double factorials[] = {
      1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040, 1.0 / 720,
      1.0 / 120,       1.0 / 24,       1.0 / 6,       0.5,          1.0,         1.0};
  for (const double term : factorials) sum = sum * r + term;
  return select(is_normal, sum * as_doubles(to_i64(n + 1023.0) << 52), Real{});
}

/// Natural logarithm of a positive, normal number. Absolute error below 1e-15 on (0, 1]. Of m 2^n, m from
/// sqrt(1/2) to sqrt(2): ln m = 2 artanh(s), s = (m - 1) / (m + 1), |s| <= 0.1716; the series to s^21
/// (remainder 4e-19).
template <typename Real>
OBLIQ_INLINE Real log_of_positive(Real x) {
  const auto bits = as_bits(x);
  Real exponent = to_doubles(bits >> 52) - 1023.0;
  Real mantissa = as_doubles((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  const Mask<Real> high = mantissa > 1.41421356237309504880;
  mantissa = select(high, mantissa * 0.5, mantissa);
  exponent = select(high, exponent + 1.0, exponent);
  const Real s = (mantissa - 1.0) / (mantissa + 1.0);
  const Real z = s * s;
  Real sum{};
#pragma GCC unroll 11
  for (int k = 21; k >= 1; k -= 2) sum = sum * z + 1.0 / k;
  return 2.0 * s * sum + exponent * 0.69314718055994530942;
}

constexpr double kNepersOfDecibel = 0.2302585092994045684;  ///< ln(10) / 10

/// 10^(db / 10), for |db| below 3000.
inline double ratio_of_db(double db) {
  const double x = kNepersOfDecibel * db;
  return x <= 0 ? exp_of_negative(x) : 1 / exp_of_negative(-x);
}
/// 10 log10(ratio), of a positive normal number.
inline double db_of_ratio(double ratio) { return log_of_positive(ratio) / kNepersOfDecibel; }
/// x^exponent, of a positive normal number.
inline double to_power(double x, double exponent) { return ratio_of_db(exponent * db_of_ratio(x)); }

}  // namespace obliq
