#include "server/radar/geometry/silhouettes.h"

#include <algorithm>
#include <cmath>

#include "server/radar/simd/lanes/exact_math.h"
#include "server/scene/tolerances.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Square of the distance from the origin to the segment a-b.
double distance2(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ab = b - a;
  const double length2 = ab.x * ab.x + ab.y * ab.y;
  const double t = length2 > 0 ? std::clamp(-(a.x * ab.x + a.y * ab.y) / length2, 0.0, 1.0) : 0.0;
  const glm::dvec2 p = a + t * ab;
  return p.x * p.x + p.y * p.y;
}

/// The slope that no part of a building between two ground distances stands above.
double top_slope(const Buildings& all, const Sector& sector, std::uint32_t building, double near_m,
                 double far_m) {
  const double above_m = static_cast<double>(all.list[building].roof_y_m) - sector.antenna_m.y;
  return above_m == 0 ? 0 : above_m / (above_m > 0 ? near_m : far_m);
}

}  // namespace

BuildingBounds bounds_of(const Buildings& all, const Sector& sector, std::uint32_t building) {
  const std::span<const glm::vec2> outline = all.outline(all.list[building]);
  if (outline.empty()) return {building, HUGE_VAL, HUGE_VAL, 0, 0, 0};
  // The circle around the rectangle that bounds it.
  const auto [low, high] = Rectangle(outline);
  const glm::dvec2 middle = (glm::dvec2(low) + glm::dvec2(high)) / 2.0;
  const glm::dvec2 half = (glm::dvec2(high) - glm::dvec2(low)) / 2.0;
  const double radius = std::sqrt(half.x * half.x + half.y * half.y) + kMargin_m;
  const double right = sector.right_m(middle.x, middle.y);
  const double ahead = sector.ahead_m(middle.x, middle.y);
  const double distance = std::sqrt(right * right + ahead * ahead);
  if (distance < 4 * radius) return silhouette_of(all, sector, building);
  // asin(x) < 1.02 x up to 1/4.
  const double to_side = 1.02 * radius / distance;
  const double bearing = std::atan2(right, ahead);
  const double near_m = distance - radius;
  const double far_m = distance + radius;
  return {building,
          near_m,
          far_m,
          bearing - to_side,
          bearing + to_side,
          top_slope(all, sector, building, near_m, far_m)};
}

Silhouette silhouette_of(const Buildings& all, const Sector& sector, std::uint32_t building) {
  const std::span<const glm::vec2> outline = all.outline(all.list[building]);
  const std::size_t n = outline.size();
  Silhouette silhouette;
  silhouette.building = building;
  if (n == 0) {
    silhouette.near_m = HUGE_VAL;
    return silhouette;
  }
  const auto corner = [&](std::size_t k) {
    const double x = static_cast<double>(outline[k % n].x);
    const double z = static_cast<double>(outline[k % n].y);
    return glm::dvec2(sector.right_m(x, z), sector.ahead_m(x, z));
  };
  // The outline runs counter-clockwise: a wall a -> b faces the antenna when the antenna is on its right.
  const auto faces = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x < 0; };
  double nearest2 = HUGE_VAL;
  double farthest2 = 0;
  double bearing = 0;
  glm::dvec2 last = corner(n - 1);
  for (std::size_t k = 0; k < n; ++k) {
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
  silhouette.top_slope = top_slope(all, sector, building, silhouette.near_m, silhouette.far_m);
  if (around) {
    silhouette.from_rad = -kPi;
    silhouette.to_rad = kPi;
    // Its roof may begin and end under any of its corners.
    silhouette.corners_rad.clear();
    for (std::size_t k = 0; k < n; ++k)
      silhouette.corners_rad.push_back(bearing_of(corner(k).x, corner(k).y));
  }
  std::sort(silhouette.corners_rad.begin(), silhouette.corners_rad.end());
  return silhouette;
}

}  // namespace obliq
