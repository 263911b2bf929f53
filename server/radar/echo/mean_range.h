#pragma once
#include <algorithm>
#include <cmath>

namespace obliq {

/// The range whose 1 / r^2 is the mean, by solid angle, over a straight segment of a vertical plane between
/// two ranges: the power of constant gamma is K gamma dOmega / r^2. Over level ground 1 / r is linear in the
/// sine of the elevation, and the mean of its square is exactly this.
inline double mean_power_range_m(double r0_m, double r1_m) {
  const double r00 = r0_m * r0_m;
  const double r01 = r0_m * r1_m;
  const double r11 = r1_m * r1_m;
  return std::clamp(r01 * std::sqrt(3 / (r00 + r01 + r11)), std::min(r0_m, r1_m), std::max(r0_m, r1_m));
}

}  // namespace obliq
