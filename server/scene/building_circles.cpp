#include "server/scene/building_circles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq {
namespace {

constexpr float kNowhere_m = 1e18f;  // out of reach of everything, and its square is a float

}  // namespace

BuildingCircles::BuildingCircles(const Buildings& buildings)
    : x_m(buildings.list.size()),
      z_m(buildings.list.size()),
      radius_m(buildings.list.size()),
      roof_y_m(buildings.list.size()) {
  for (std::size_t b = 0; b < size(); ++b) {
    const Building& building = buildings.list[b];
    const std::span<const glm::vec2> outline = buildings.outline(building);
    roof_y_m[b] = building.roof_y_m;
    if (outline.empty()) {
      x_m[b] = z_m[b] = kNowhere_m;
      continue;
    }
    const auto [low, high] = Rectangle(outline);
    const glm::dvec2 middle = (glm::dvec2(low) + glm::dvec2(high)) / 2.0;
    x_m[b] = static_cast<float>(middle.x);
    z_m[b] = static_cast<float>(middle.y);
    double radius2 = 0;
    for (const glm::vec2& corner : outline) {
      const glm::dvec2 p =
          glm::dvec2(corner) - glm::dvec2(static_cast<double>(x_m[b]), static_cast<double>(z_m[b]));
      radius2 = std::max(radius2, p.x * p.x + p.y * p.y);
    }
    radius_m[b] =
        std::nextafter(static_cast<float>(std::sqrt(radius2)), std::numeric_limits<float>::infinity());
    reach_m = std::max({reach_m, std::abs(middle.x), std::abs(middle.y)});
  }
}

}  // namespace obliq
