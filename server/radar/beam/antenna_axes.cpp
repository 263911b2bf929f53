#include "server/radar/beam/antenna_axes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace obliq {
namespace {

SinCos sincos(double angle_rad) { return sincos_turns(angle_rad / (2 * std::numbers::pi)); }

}  // namespace

AntennaAxes::AntennaAxes(double roll_rad, double pitch_rad, double nose_rad)
    : is_level_(roll_rad == 0 && pitch_rad == 0) {
  if (is_level_) return;
  const SinCos roll = sincos(roll_rad);
  const SinCos pitch = sincos(pitch_rad);
  const SinCos nose = sincos(nose_rad);
  // The platform's axes along its heading, to the right of it, and upwards.
  const glm::dvec3 platform_ahead{pitch.cos, 0, pitch.sin};
  const glm::dvec3 platform_right{pitch.sin * roll.sin, roll.cos, -pitch.cos * roll.sin};
  const glm::dvec3 platform_up{-pitch.sin * roll.cos, roll.sin, pitch.cos * roll.cos};
  // The same along the sector's centre, to the right of it, and upwards.
  const auto from_centre = [&](const glm::dvec3& v) {
    return glm::dvec3{v.x * nose.cos + v.y * nose.sin, v.y * nose.cos - v.x * nose.sin, v.z};
  };
  ahead_ = from_centre(platform_ahead * nose.cos + platform_right * nose.sin);
  right_ = from_centre(platform_right * nose.cos - platform_ahead * nose.sin);
  up_ = from_centre(platform_up);
}

double AntennaAxes::lean_rad() const { return std::acos(std::clamp(up_.z, -1.0, 1.0)); }

glm::dvec3 AntennaAxes::own(const glm::dvec3& level) const {
  return {glm::dot(ahead_, level), glm::dot(right_, level), glm::dot(up_, level)};
}

glm::dvec3 AntennaAxes::level(const glm::dvec3& own) const {
  return own.x * ahead_ + own.y * right_ + own.z * up_;
}

double AntennaAxes::azimuth_seen_rad(SinCos scan, double sin_elevation) const {
  // Of all own elevations at this scan angle the one whose direction has that sine: flat sin + rise cos = s.
  const double flat = ahead_.z * scan.cos + right_.z * scan.sin;
  const double length = std::hypot(flat, up_.z);
  const double own_rad = std::asin(std::clamp(sin_elevation / length, -1.0, 1.0)) - std::atan2(flat, up_.z);
  const double level = std::cos(own_rad);
  const glm::dvec3 at = this->level({level * scan.cos, level * scan.sin, std::sin(own_rad)});
  return bearing_of(at.y, at.x);
}

}  // namespace obliq
