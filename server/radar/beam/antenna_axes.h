#pragma once
#include <glm/vec3.hpp>

#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {

/// How an antenna that is not stabilised stands in the world: it turns about its platform's own vertical axis
/// instead of the world's. Level directions are (ahead, right, up), ahead along the bearing of the sector's
/// centre; own ones likewise, ahead along the scan angle of the sector's centre, which counts from the
/// platform's nose as bearings count from its heading. Roll, pitch and heading as aircraft have them (ISO
/// 1151-1): roll first, right side down positive, then pitch, nose up positive. Immutable.
class AntennaAxes {
 public:
  /// Of a level platform.
  AntennaAxes() = default;
  /// nose_rad: bearing of the sector's centre, clockwise from the platform's nose.
  AntennaAxes(double roll_rad, double pitch_rad, double nose_rad);

  bool is_level() const { return is_level_; }
  /// Of the platform's vertical axis: its parts along the sector's centre, to its right, and upwards.
  const glm::dvec3& up() const { return up_; }
  /// Between the platform's vertical axis and the world's, in [0, pi].
  double lean_rad() const;

  /// A level direction in own axes, and back.
  glm::dvec3 own(const glm::dvec3& level) const;
  glm::dvec3 level(const glm::dvec3& own) const;

  /// The azimuth about the sector's centre at which ground at this sine of elevation is seen, by an antenna
  /// with its scan angle so far clockwise from the centre's.
  double azimuth_seen_rad(SinCos scan, double sin_elevation) const;

 private:
  bool is_level_ = true;
  glm::dvec3 ahead_{1, 0, 0};
  glm::dvec3 right_{0, 1, 0};
  glm::dvec3 up_{0, 0, 1};
};

}  // namespace obliq
