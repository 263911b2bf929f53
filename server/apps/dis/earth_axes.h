#pragma once
// Places and axes in the earth's frame, in which DIS says everything: metres from its centre, x through 0 N 0
// E, z through the north pole (WGS84).
#include <glm/vec3.hpp>

namespace obliq {

/// Degrees, metres above the ellipsoid.
struct Place {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;
};

Place place_of(const glm::dvec3& location_m);
glm::dvec3 location_of(const Place& place);

/// Of a place, in the earth's axes.
struct LocalAxes {
  glm::dvec3 north, east, up;
};
LocalAxes local_axes(const Place& at);

/// Of a body, in the earth's axes: its x, y and z in DIS.
struct BodyAxes {
  glm::dvec3 nose{1, 0, 0}, right{0, 1, 0}, below{0, 0, 1};
};
/// IEEE 1278.1-2012, 6.2.32: the earth's axes turn by psi about z, then by theta about y, then by phi about
/// x.
BodyAxes body_axes(double psi, double theta, double phi);
/// What is said along the body's axes, along the earth's.
glm::dvec3 from_body(const BodyAxes& body, const glm::dvec3& along);

/// A vector that turns for so long about an axis, as fast as the axis is long (rad/s): Rodrigues' formula.
glm::dvec3 turned(const glm::dvec3& vector, const glm::dvec3& turn_rad_s, double after_s);

bool is_finite(const glm::dvec3& vector);

}  // namespace obliq
