#include "server/radar/profile/plumb_line.h"

#include <cmath>

namespace obliq {
namespace {

constexpr int kMostSteps = 8;
constexpr double kNear_m = 1e-4;

}  // namespace

PlumbLine::PlumbLine(const WorldFrame& frame, double latitude_rad, double longitude_rad) : frame_(frame) {
  foot_ = frame.world_from_geodetic({latitude_rad, longitude_rad, 0}).m;
  foot_.y += frame.lift_m(foot_.x, foot_.z);
  // Up and north at the place in the axes of the origin: both are turned about the earth's axis by the
  // difference of longitude, then by the origin's latitude (GeographicLib, Geocentric::Rotation).
  const double turn = longitude_rad - frame.origin_longitude_rad();
  const double sin_here = std::sin(latitude_rad), cos_here = std::cos(latitude_rad);
  const double sin_origin = std::sin(frame.origin_latitude_rad());
  const double cos_origin = std::cos(frame.origin_latitude_rad());
  const double sin_turn = std::sin(turn), cos_turn = std::cos(turn);
  up_ = {cos_here * sin_turn, sin_origin * sin_here + cos_origin * cos_here * cos_turn,
         cos_origin * sin_here - sin_origin * cos_here * cos_turn};
  north_rad_ = std::atan2(-sin_here * sin_turn, cos_origin * cos_here + sin_origin * sin_here * cos_turn);
}

glm::dvec3 PlumbLine::at_height(double height_m) const {
  const glm::dvec3 point = foot_ + height_m * up_;
  return {point.x, point.y - frame_.lift_m(point.x, point.z), point.z};
}

template <class YAt>
std::optional<PlumbLine::Meeting> PlumbLine::meet_surface(const YAt& y_at) const {
  // Each step takes the surface's y at the last step's place: what is left shrinks by the line's lean times
  // the surface's slope, a hundredth or less.
  double height = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const glm::dvec3 point = foot_ + height * up_;
    const double y = y_at(point.x, point.z);
    if (std::isnan(y)) return std::nullopt;
    const double next = (y + frame_.lift_m(point.x, point.z) - foot_.y) / up_.y;
    const bool there = std::abs(next - height) < kNear_m;
    height = next;
    if (there) break;
  }
  return Meeting{height, at_height(height)};
}

std::optional<PlumbLine::Meeting> PlumbLine::meet(const HeightGrid& grid) const {
  if (!(up_.y > 0)) return std::nullopt;  // the other half of the earth
  return meet_surface([&](double x, double z) { return grid.height_at_m(x, z); });
}

PlumbLine::Meeting PlumbLine::meet(double y_m) const {
  return *meet_surface([&](double, double) { return y_m; });
}

}  // namespace obliq
