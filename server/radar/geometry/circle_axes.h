#pragma once
#include <algorithm>
#include <cmath>

#include "server/radar/geometry/sector.h"
#include "server/radar/simd/buildings/circles.h"
#include "server/scene/building_circles.h"

namespace obliq {

/// Antenna axes for the kernels over circles. Differences of coordinates, the turn into antenna axes and the
/// root of the squares are ten roundings of 2^-24 of at most twice the largest coordinate: 2^-19 of it is
/// half as much again.
inline CircleAxes circle_axes(const BuildingCircles& circles, const Sector& sector) {
  const glm::dvec3& at = sector.antenna_m;
  const double largest_m = circles.reach_m + std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
  return {static_cast<float>(at.x),
          static_cast<float>(at.y),
          static_cast<float>(at.z),
          static_cast<float>(sector.sin_bearing),
          static_cast<float>(sector.cos_bearing),
          static_cast<float>(std::ldexp(largest_m, -19) + 1e-3)};
}

inline CircleRun circle_run(const BuildingCircles& circles, std::size_t from, std::size_t count) {
  return {circles.x_m.data() + from, circles.z_m.data() + from, circles.radius_m.data() + from,
          circles.roof_y_m.data() + from, static_cast<int>(count)};
}

}  // namespace obliq
