#pragma once
// Elementary functions whose bits do not depend on the C library's choice by processor. Plain IEEE double
// operations only (the project is built with -ffp-contract=off). tests/unit/radar_exact_math_test.cpp
// measures their errors against the C library in long double.
#include <bit>
#include <cmath>
#include <cstdint>

#include "server/radar/simd/exact_series.h"

namespace obliq {

struct SinCos {
  double sin;
  double cos;
};

/// sin and cos of 2 pi turns, |turns| < 2^51. Error below 3e-16: the reduction modulo one turn is exact.
inline SinCos sincos_turns(double turns) {
  const auto [quarters, s, c] = quarter_turns(turns);
  switch (static_cast<int>(quarters) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
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
  constexpr double kPi = 3.14159265358979323846;
  const double tangent = s < c ? s / c : c / s;
  double angle = tangent * (kPi / 4 + 0.273 * (1 - tangent));
  if (s >= c) angle = kPi / 2 - angle;
  if (cosine < 0) angle = kPi - angle;
  if (sine < 0) angle = -angle;
  for (int step = 0; step < 2; ++step) {
    const SinCos at = sincos_turns(angle / (2 * kPi));
    const double off = sine * at.cos - cosine * at.sin;  // sin of what is missing
    angle += off + off * off * off / 6;
  }
  return angle;
}

/// exp(x) for x <= 0; 0 below -700. Relative error below 4e-16.
inline double exp_of_negative(double x) {
  if (!(x > -700)) return 0;
  // x = n ln 2 + r with |r| <= ln 2 / 2; ln 2 in two parts so that n ln 2 is exact to the last bit of r.
  const double n = nearest_integer(x * 1.4426950408889634074);
  const double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
  double term = 1;
  double sum = 0;
  for (int k = 13; k >= 1; --k) sum = (sum + 1) * r / k;  // Horner form of r + r^2/2! + ... + r^13/13!
  term += sum;
  return term * std::bit_cast<double>(static_cast<std::uint64_t>(static_cast<std::int64_t>(n) + 1023) << 52);
}

/// Natural logarithm of a positive, normal number. Absolute error below 1e-15 on (0, 1].
inline double log_of_positive(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<int>(bits >> 52) - 1023;
  double mantissa = std::bit_cast<double>((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  if (mantissa > 1.41421356237309504880) {
    mantissa *= 0.5;
    ++exponent;
  }
  return log_of_parts(mantissa, static_cast<double>(exponent));
}

}  // namespace obliq
