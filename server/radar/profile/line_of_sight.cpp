#include "server/radar/profile/line_of_sight.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>

#include "server/scene/tolerances.h"

namespace obliq {

void LineOfSight::cut_roofs(double from_m) {
  std::erase_if(spans_, [&](const RoofSpan& span) { return span.far_m <= from_m; });
  for (const RoofSpan& span : spans_) walk_.reach(span.far_m);
  steps_ = disjoint_roofs(spans_);
  std::erase_if(steps_, [](const RoofSpan& step) { return !(step.near_m < step.far_m); });
  step_ = 0;
  while (step_ < steps_.size() && steps_[step_].far_m <= from_m) ++step_;
  next_wall_ = step_ < steps_.size() && steps_[step_].near_m < from_m ? step_ + 1 : step_;
}

bool LineOfSight::covers(const RoofSpan& span) const {
  return std::any_of(spans_.begin(), spans_.end(), [&](const RoofSpan& other) {
    return other.building != span.building && other.roof_y_m >= span.roof_y_m &&
           other.near_m <= span.near_m + kTouching_m && other.far_m >= span.far_m - kTouching_m;
  });
}

void LineOfSight::raise_by_roofs(Horizon<double>& horizon, const RoofSpan& before) const {
  for (const RoofSpan& other : spans_) {
    if (other.building == before.building || !(other.near_m < before.near_m)) continue;
    const double height = other.roof_y_m - antenna_m_.y;
    horizon.raise(other.near_m, height, true);
    horizon.raise(std::min(other.far_m, before.near_m), height, true);
  }
}

LineOfSight::WallPlane LineOfSight::wall_plane(const RoofSpan& step) const {
  const Buildings& all = world_->buildings;
  const WallEdge edge = edge_of_wall(all, step.wall);
  const glm::dvec2 antenna(antenna_m_.x, antenna_m_.z);
  const glm::dvec2 a = glm::dvec2(all.ring_xz_m[edge.from]) - antenna;
  const glm::dvec2 b = glm::dvec2(all.ring_xz_m[edge.to]) - antenna;
  const glm::dvec2 along = b - a;
  const double length2 = along.x * along.x + along.y * along.y;
  if (!(length2 > 0)) return {0, 0, 0, 0, 0};
  const double length = std::sqrt(length2);
  // The solid lies on the left of a -> b on a map, so (dz, -dx) points out of it.
  const double distance = (a.y * along.x - a.x * along.y) / length;
  const double to_a = std::sqrt(a.x * a.x + a.y * a.y);
  const double to_b = std::sqrt(b.x * b.x + b.y * b.y);
  const double foot = -(a.x * along.x + a.y * along.y);
  return {distance, along.y / length, -along.x / length,
          std::min({foot > 0 && foot < length2 ? std::abs(distance) : to_a, to_a, to_b}),
          std::max(to_a, to_b)};
}

}  // namespace obliq
