#pragma once
#include <cmath>
#include <numbers>

namespace obliq {

/// One-way power gain of the antenna. One function of direction; constant until beam shapes come.
class AntennaPattern {
 public:
  explicit AntennaPattern(double gain_db) : gain_(std::pow(10.0, gain_db / 10)) {}

  /// Linear power gain G towards an azimuth offset (clockwise from the sector's centre) and an elevation,
  /// given by its sine as the rays have it.
  double power_gain(double /*azimuth_offset_rad*/, double /*sin_elevation*/) const { return gain_; }

 private:
  double gain_;
};

/// K = P lambda^2 / (4 pi)^3 of the monostatic radar equation, K G^2 sigma / r^4 (Richards 2014, eq. 2.8).
inline double radar_equation_constant(double power_w, double wavelength_m) {
  constexpr double kFourPi = 4 * std::numbers::pi;
  return power_w * wavelength_m * wavelength_m / (kFourPi * kFourPi * kFourPi);
}

}  // namespace obliq
