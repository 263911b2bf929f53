#pragma once
#include <cstdint>

#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// Circles around buildings (server/scene/building_circles.h), from some building on.
struct CircleRun {
  const float* x_m;
  const float* z_m;
  const float* radius_m;
  const float* roof_y_m;
  int n;
};

/// Antenna axes in floats.
struct CircleAxes {
  float x_m, y_m, z_m;  ///< the antenna
  float sin_bearing, cos_bearing;
  float error_m;  ///< more than any distance, height or difference of the two is off
};

/// Azimuth bins by bearing from the sector's centre.
struct CircleSector {
  CircleAxes axes;
  float reach_m;  ///< over ground
  float start_rad, end_rad;
  float bins_a_rad;  ///< 0: bins too narrow for floats
  int n_bins;
};

constexpr std::int32_t kNoBin = -1;       ///< as a last bin: the circle is in none
constexpr std::int32_t kLookCloser = -2;  ///< as a last bin: the circle does not tell

/// First and last bin [n] of each circle, and perhaps of its neighbours.
OBLIQ_KERNEL(void, circle_bins, const CircleSector&, const CircleRun&, std::int32_t* first,
             std::int32_t* last);

/// How far off a bearing of circle_bins may be: 2e-8 for the polynomial, and a dozen roundings of 2^-24 of at
/// most a turn.
constexpr double kBearingMargin_rad = 8e-6;

/// Sector and swath, and what has been found in it.
struct CircleExtent {
  CircleAxes axes;
  bool wide;  ///< a sector of more than half a turn
  float sin_half, cos_half;
  float r_min_m, r_max_m;
  float margin_m;  ///< around sector and swath
  float top_m;     ///< the highest roof
  float tangent;   ///< of the highest elevation
};

/// Marks [n] those that lie outside, or well inside and neither higher nor at a higher elevation.
OBLIQ_KERNEL(void, idle_circles, const CircleExtent&, const CircleRun&, std::uint8_t* idle);

}  // namespace obliq
