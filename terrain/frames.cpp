#include "terrain/frames.h"

#include <GeographicLib/Constants.hpp>
#include <cmath>
#include <vector>

#include "terrain/base/units.h"

namespace obliq {
WorldFrame::WorldFrame(double origin_latitude_rad, double origin_longitude_rad, double radius_factor)
    : origin_latitude_rad_(origin_latitude_rad),
      origin_longitude_rad_(origin_longitude_rad),
      radius_factor_(radius_factor),
      ellipsoid_(tangent_form(origin_latitude_rad)),
      tangent_(origin_latitude_rad / kDegree_rad, origin_longitude_rad / kDegree_rad, 0.0) {}

WorldFrame::TangentForm WorldFrame::tangent_form(double origin_latitude_rad) {
  // With p = (X, Y, Z) in earth-centred axes, rotated so that the origin's meridian is the X-Z plane, the
  // ellipsoid is X^2 + Y^2 + Z^2 / (1 - e^2) = a^2. The origin satisfies it, so with the offset
  // d = x east + y up + z north the constant term is 2 <p0, d> + <d, d> alone: no large numbers cancel.
  const double a = GeographicLib::Constants::WGS84_a();
  const double f = GeographicLib::Constants::WGS84_f();
  const double e2 = f * (2 - f);
  const double sin_lat = std::sin(origin_latitude_rad);
  const double cos_lat = std::cos(origin_latitude_rad);
  const double weight = 1 / (1 - e2);
  // East is (0, 1, 0), north (-sin, 0, cos), up (cos, 0, sin); p0 = N (cos, 0, (1 - e2) sin).
  // <p0, east> = <p0, north> = 0 and <p0, up> = N, in the ellipsoid's own scalar product.
  return {.normal_radius = a / std::sqrt(1 - e2 * sin_lat * sin_lat),
          .up_up = cos_lat * cos_lat + weight * sin_lat * sin_lat,
          .up_north = (weight - 1) * sin_lat * cos_lat,
          .north_north = sin_lat * sin_lat + weight * cos_lat * cos_lat};
}

double WorldFrame::ellipsoid_y_m(double x_m, double z_m) const {
  const double half_b = ellipsoid_.normal_radius + ellipsoid_.up_north * z_m;
  const double c = x_m * x_m + ellipsoid_.north_north * z_m * z_m;
  // The root near zero, in the form that does not cancel.
  const double root = std::sqrt(std::fmax(0.0, half_b * half_b - ellipsoid_.up_up * c));
  return -c / (half_b + root);
}

double WorldFrame::lift_m(double x_m, double z_m) const {
  if (radius_factor_ == 1) return 0;
  return (1 - 1 / radius_factor_) * ellipsoid_y_m(x_m, z_m);
}

WorldPoint WorldFrame::world_from_geodetic(const Geodetic& geodetic) const {
  double east, north, up;
  tangent_.Forward(geodetic.latitude_rad / kDegree_rad, geodetic.longitude_rad / kDegree_rad,
                   geodetic.height_m, east, north, up);
  return WorldPoint{glm::dvec3(east, up - lift_m(east, north), north)};
}

Geodetic WorldFrame::geodetic_from_world(const WorldPoint& world) const {
  double latitude_deg, longitude_deg, height_m;
  tangent_.Reverse(world.m.x, world.m.z, world.m.y + lift_m(world.m.x, world.m.z), latitude_deg,
                   longitude_deg, height_m);
  return Geodetic{latitude_deg * kDegree_rad, longitude_deg * kDegree_rad, height_m};
}

double WorldFrame::north_rad(const Geodetic& geodetic) const {
  double east, north, up;
  std::vector<double> rotation(9);
  tangent_.Forward(geodetic.latitude_rad / kDegree_rad, geodetic.longitude_rad / kDegree_rad,
                   geodetic.height_m, east, north, up, rotation);
  // Row-major; column 1 is the local north direction in the tangent frame (east, north, up).
  return std::atan2(rotation[1], rotation[4]);
}

}  // namespace obliq
