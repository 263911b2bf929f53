#pragma once
#include <glm/vec3.hpp>
#include <numbers>

#include "server/radar/geometry/pose.h"
#include "server/radar/settings.h"
#include "server/radar/simd/ground/rays.h"
#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {

/// The azimuth sector and slant-range swath of a frame, in world axes. Offsets are clockwise from its centre.
struct Sector {
  glm::dvec3 antenna_m{0.0};
  double bearing_rad = 0;  ///< world angle of the centre
  double sin_bearing = 0;
  double cos_bearing = 1;
  double width_rad = 0;  ///< S, 0 < S <= 2 pi
  double r_min_m = 0;
  double r_max_m = 0;

  Sector(const RadarSettings& settings, const Pose& pose);

  /// A horizontal world offset from the antenna in antenna axes: right of and ahead along the centre bearing.
  double right_m(double x_m, double z_m) const {
    return (x_m - antenna_m.x) * cos_bearing - (z_m - antenna_m.z) * sin_bearing;
  }
  double ahead_m(double x_m, double z_m) const {
    return (x_m - antenna_m.x) * sin_bearing + (z_m - antenna_m.z) * cos_bearing;
  }
  /// A direction in antenna axes (right, up, ahead) in world axes.
  glm::dvec3 world_from_antenna(double right, double up, double ahead) const {
    return {right * cos_bearing + ahead * sin_bearing, up, ahead * cos_bearing - right * sin_bearing};
  }
  /// Sine and cosine of the world angle at an offset.
  SinCos world_bearing(double offset_rad) const {
    const SinCos offset = sincos_turns(offset_rad / (2 * std::numbers::pi));
    const glm::dvec3 ahead = world_from_antenna(offset.sin, 0, offset.cos);
    return {ahead.x, ahead.z};
  }
};

/// The paper's terrain bounding box in antenna axes (Figure 3; PAPER.md, eqs. (16) to (28)).
struct SectorBox {
  double antenna_above_bottom_m = 0;  ///< y_c - y_tb
  double height_m = 0;                ///< W_y
  double kappa_m = 0;                 ///< y_c - y_tb - W_y, eq. (22); negative: ground above the antenna
  double g_min_m = 0;
  double g_max_m = 0;
  double near_z_m = 0;  ///< d: the close edge, ahead of the antenna; negative beyond 180 degrees
  double depth_m = 0;   ///< W_z
  double width_m = 0;   ///< W_x

  SectorBox(double antenna_above_bottom_m, double height_m, double r_min_m, double r_max_m,
            double sector_rad);
};

inline SwathTest swath_test(const SectorBox& box, const Sector& sector) {
  return {box.antenna_above_bottom_m, box.kappa_m, sector.r_min_m, sector.r_max_m};
}

}  // namespace obliq
