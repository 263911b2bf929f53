#include "server/radar/geometry/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "server/radar/simd/exact_math.h"
#include "server/scene/tolerances.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;

/// Square of the distance from the origin to the segment a-b.
double distance2(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ab = b - a;
  const double length2 = ab.x * ab.x + ab.y * ab.y;
  const double t = length2 > 0 ? std::clamp(-(a.x * ab.x + a.y * ab.y) / length2, 0.0, 1.0) : 0.0;
  const glm::dvec2 p = a + t * ab;
  return p.x * p.x + p.y * p.y;
}

}  // namespace

RoughBearings rough_bearings_of(const Buildings& all, const Sector& sector, std::uint32_t building) {
  const std::uint32_t ring = all.list[building].first_ring;
  const std::uint32_t begin = all.ring_start[ring];
  const std::uint32_t end = all.ring_start[ring + 1];
  if (begin == end) return {HUGE_VAL, HUGE_VAL, 0, 0};
  // The circle around the rectangle that bounds it.
  glm::vec2 low = all.ring_xz_m[begin];
  glm::vec2 high = low;
  for (std::uint32_t k = begin + 1; k < end; ++k) {
    low = glm::min(low, all.ring_xz_m[k]);
    high = glm::max(high, all.ring_xz_m[k]);
  }
  const glm::dvec2 middle = (glm::dvec2(low) + glm::dvec2(high)) / 2.0;
  const glm::dvec2 half = (glm::dvec2(high) - glm::dvec2(low)) / 2.0;
  const double radius = std::sqrt(half.x * half.x + half.y * half.y) + kMargin_m;
  const double right = sector.right_m(middle.x, middle.y);
  const double ahead = sector.ahead_m(middle.x, middle.y);
  const double distance = std::sqrt(right * right + ahead * ahead);
  if (distance < 4 * radius) {
    const Silhouette near = silhouette_of(all, sector, building);
    return {near.near_m, near.far_m, near.from_rad, near.to_rad};
  }
  // asin(x) < 1.02 x up to 1/4.
  const double to_side = 1.02 * radius / distance;
  const double bearing = std::atan2(right, ahead);
  return {distance - radius, distance + radius, bearing - to_side, bearing + to_side};
}

Silhouette silhouette_of(const Buildings& all, const Sector& sector, std::uint32_t building) {
  const std::uint32_t ring = all.list[building].first_ring;
  const std::uint32_t begin = all.ring_start[ring];
  const std::uint32_t n = all.ring_start[ring + 1] - begin;
  Silhouette silhouette;
  silhouette.building = building;
  if (n == 0) {
    silhouette.near_m = HUGE_VAL;
    return silhouette;
  }
  const auto corner = [&](std::uint32_t k) {
    const double x = static_cast<double>(all.ring_xz_m[begin + k % n].x);
    const double z = static_cast<double>(all.ring_xz_m[begin + k % n].y);
    return glm::dvec2(sector.right_m(x, z), sector.ahead_m(x, z));
  };
  // The outline runs counter-clockwise: a wall a -> b faces the antenna when the antenna is on its right.
  const auto faces = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x < 0; };
  double nearest2 = HUGE_VAL;
  double farthest2 = 0;
  double bearing = 0;
  glm::dvec2 last = corner(n - 1);
  for (std::uint32_t k = 0; k < n; ++k) {
    const glm::dvec2 here = corner(k);
    const glm::dvec2 next = corner(k + 1);
    nearest2 = std::min(nearest2, distance2(here, next));
    farthest2 = std::max(farthest2, here.x * here.x + here.y * here.y);
    const double at = bearing_of(here.x, here.y);
    const double turn = at - bearing;
    bearing = k == 0 ? at : bearing + (std::abs(turn) < kPi ? turn : std::remainder(turn, 2 * kPi));
    if (k == 0) silhouette.from_rad = silhouette.to_rad = bearing;
    silhouette.from_rad = std::min(silhouette.from_rad, bearing);
    silhouette.to_rad = std::max(silhouette.to_rad, bearing);
    if (faces(last, here) || faces(here, next)) silhouette.corners_rad.push_back(bearing);
    last = here;
  }
  const glm::dvec2 first = corner(0);
  const double closing = bearing + std::remainder(bearing_of(first.x, first.y) - bearing, 2 * kPi);
  const bool around =
      std::abs(closing - bearing_of(first.x, first.y)) > kPi || silhouette.to_rad - silhouette.from_rad > kPi;
  silhouette.near_m = around ? 0 : std::max(0.0, std::sqrt(nearest2) - kMargin_m);
  silhouette.far_m = std::sqrt(farthest2) + kMargin_m;
  if (around) {
    silhouette.from_rad = -kPi;
    silhouette.to_rad = kPi;
    // Its roof may begin and end under any of its corners.
    silhouette.corners_rad.clear();
    for (std::uint32_t k = 0; k < n; ++k)
      silhouette.corners_rad.push_back(bearing_of(corner(k).x, corner(k).y));
  }
  std::sort(silhouette.corners_rad.begin(), silhouette.corners_rad.end());
  return silhouette;
}

}  // namespace obliq
