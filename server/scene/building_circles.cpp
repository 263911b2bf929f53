#include "server/scene/building_circles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
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
    const std::uint32_t begin = buildings.ring_start[building.first_ring];
    const std::uint32_t end = buildings.ring_start[building.first_ring + 1];
    roof_y_m[b] = building.roof_y_m;
    if (begin == end) {
      x_m[b] = z_m[b] = kNowhere_m;
      continue;
    }
    glm::vec2 low = buildings.ring_xz_m[begin];
    glm::vec2 high = low;
    for (std::uint32_t k = begin + 1; k < end; ++k) {
      low = glm::min(low, buildings.ring_xz_m[k]);
      high = glm::max(high, buildings.ring_xz_m[k]);
    }
    const glm::dvec2 middle = (glm::dvec2(low) + glm::dvec2(high)) / 2.0;
    x_m[b] = static_cast<float>(middle.x);
    z_m[b] = static_cast<float>(middle.y);
    double radius2 = 0;
    for (std::uint32_t k = begin; k < end; ++k) {
      const glm::dvec2 p = glm::dvec2(buildings.ring_xz_m[k]) -
                           glm::dvec2(static_cast<double>(x_m[b]), static_cast<double>(z_m[b]));
      radius2 = std::max(radius2, p.x * p.x + p.y * p.y);
    }
    radius_m[b] =
        std::nextafter(static_cast<float>(std::sqrt(radius2)), std::numeric_limits<float>::infinity());
    reach_m = std::max({reach_m, std::abs(middle.x), std::abs(middle.y)});
  }
}

}  // namespace obliq
