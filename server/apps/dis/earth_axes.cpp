#include "server/apps/dis/earth_axes.h"

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "terrain/base/units.h"

namespace obliq {

Place place_of(const glm::dvec3& location_m) {
  Place place;
  GeographicLib::Geocentric::WGS84().Reverse(location_m.x, location_m.y, location_m.z, place.latitude_deg,
                                             place.longitude_deg, place.height_m);
  return place;
}

glm::dvec3 location_of(const Place& place) {
  glm::dvec3 location_m;
  GeographicLib::Geocentric::WGS84().Forward(place.latitude_deg, place.longitude_deg, place.height_m,
                                             location_m.x, location_m.y, location_m.z);
  return location_m;
}

LocalAxes local_axes(const Place& at) {
  const double phi = at.latitude_deg * kDegree_rad;
  const double lambda = at.longitude_deg * kDegree_rad;
  const double across = std::cos(lambda), along = std::sin(lambda);
  return {{-std::sin(phi) * across, -std::sin(phi) * along, std::cos(phi)},
          {-along, across, 0},
          {std::cos(phi) * across, std::cos(phi) * along, std::sin(phi)}};
}

BodyAxes body_axes(double psi, double theta, double phi) {
  const glm::dvec3 level{-std::sin(psi), std::cos(psi), 0};  // y before phi
  const glm::dvec3 below{std::sin(theta) * std::cos(psi), std::sin(theta) * std::sin(psi), std::cos(theta)};
  return {{std::cos(theta) * std::cos(psi), std::cos(theta) * std::sin(psi), -std::sin(theta)},
          std::cos(phi) * level + std::sin(phi) * below,
          std::cos(phi) * below - std::sin(phi) * level};
}

glm::dvec3 from_body(const BodyAxes& body, const glm::dvec3& along) {
  return along.x * body.nose + along.y * body.right + along.z * body.below;
}

glm::dvec3 turned(const glm::dvec3& vector, const glm::dvec3& turn_rad_s, double after_s) {
  const double rate_rad_s = glm::length(turn_rad_s);
  if (rate_rad_s == 0) return vector;
  const glm::dvec3 axis = turn_rad_s / rate_rad_s;
  const double angle = rate_rad_s * after_s;
  const double half = std::sin(angle / 2);  // 1 - cos without cancellation
  return std::cos(angle) * vector + std::sin(angle) * glm::cross(axis, vector) +
         2 * half * half * glm::dot(axis, vector) * axis;
}

bool is_finite(const glm::dvec3& vector) {
  return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

}  // namespace obliq
