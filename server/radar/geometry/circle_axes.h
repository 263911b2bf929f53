#pragma once
#include <algorithm>
#include <cmath>

#include "server/radar/geometry/sector.h"
#include "server/scene/building_circles.h"

namespace obliq {

/// Antenna axes in floats, for loops over circles that take several at a time and look closer at those that
/// they cannot decide.
struct CircleAxes {
  float x_m, y_m, z_m;  ///< the antenna
  float sin_bearing, cos_bearing;
  /// More than any distance is off: differences of coordinates, the turn into antenna axes and the root of
  /// the squares are ten roundings of 2^-24 of at most twice the largest coordinate, and this is thrice that.
  float error_m;

  CircleAxes(const BuildingCircles& circles, const Sector& sector)
      : x_m(static_cast<float>(sector.antenna_m.x)),
        y_m(static_cast<float>(sector.antenna_m.y)),
        z_m(static_cast<float>(sector.antenna_m.z)),
        sin_bearing(static_cast<float>(sector.sin_bearing)),
        cos_bearing(static_cast<float>(sector.cos_bearing)) {
    const glm::dvec3& at = sector.antenna_m;
    const double largest_m = circles.reach_m + std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    error_m = static_cast<float>(std::ldexp(largest_m, -18) + 1e-3);
  }

  float right_m(float x, float z) const { return (x - x_m) * cos_bearing - (z - z_m) * sin_bearing; }
  float ahead_m(float x, float z) const { return (x - x_m) * sin_bearing + (z - z_m) * cos_bearing; }
};

}  // namespace obliq
