#include "server/radar/rays/roof_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/radar/geometry/silhouettes.h"
#include "server/scene/tolerances.h"

namespace obliq {
namespace {}  // namespace

RoofLine::RoofLine(const Buildings& all, const Sector& sector, std::span<const std::uint32_t> buildings) {
  for (const std::uint32_t b : buildings) {
    const RoughBearings bounds = rough_bearings_of(all, sector, b);
    const double near_m = std::max(0.0, bounds.near_m);
    const double above_m = static_cast<double>(all.list[b].roof_y_m) - sector.antenna_m.y;
    roofs_.push_back({near_m, above_m == 0 ? 0 : above_m / (above_m > 0 ? near_m : bounds.far_m)});
  }
  std::sort(roofs_.begin(), roofs_.end(), [](const Roof& a, const Roof& b) { return a.near_m < b.near_m; });
  double slope = -std::numeric_limits<double>::infinity();
  for (Roof& roof : roofs_) roof.slope = slope = std::max(slope, roof.slope);
}

double RoofLine::free_range_m(const glm::dvec3& direction) const {
  if (roofs_.empty()) return std::numeric_limits<double>::infinity();
  const double level = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  const double slope = direction.y / level - kSlopeMargin;
  const auto first = std::partition_point(roofs_.begin(), roofs_.end(),
                                          [&](const Roof& roof) { return roof.slope < slope; });
  if (first == roofs_.end()) return std::numeric_limits<double>::infinity();
  return first->near_m > 0 ? first->near_m / level : 0;
}

}  // namespace obliq
