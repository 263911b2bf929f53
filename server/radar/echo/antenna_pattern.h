#pragma once
#include <cmath>

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

}  // namespace obliq
