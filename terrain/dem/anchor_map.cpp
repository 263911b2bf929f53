#include "terrain/dem/anchor_map.h"

#include <cmath>

#include "terrain/base/units.h"

namespace obliq {

AnchorMap::AnchorMap(const WorldFrame& frame, const std::optional<LonLat>& anchor) : frame_(frame) {
  if (!anchor) return;
  const double latitude_rad = anchor->latitude_deg * kDegree_rad;
  const double longitude_rad = anchor->longitude_deg * kDegree_rad;
  if (latitude_rad == frame.origin_latitude_rad() && longitude_rad == frame.origin_longitude_rad()) return;
  anchor_.emplace(latitude_rad, longitude_rad, frame.radius_factor());
}

glm::dvec2 AnchorMap::exact(const glm::dvec2& p) const {
  if (!anchor_) return p;
  Geodetic place = frame_.geodetic_from_world({glm::dvec3(p.x, frame_.datum_y_m(p.x, p.y), p.y)});
  place.height_m = 0;
  const WorldPoint there = anchor_->world_from_geodetic(place);
  return {there.m.x, there.m.z};
}

AnchorMap::Row::Row(const AnchorMap& map, double z_m) : map_(map), z_m_(z_m) {}

glm::dvec2 AnchorMap::Row::column(double i) const {
  const double j = std::floor(z_m_ / kStep_m);
  const double t = z_m_ / kStep_m - j;
  const glm::dvec2 low = map_.exact({i * kStep_m, j * kStep_m});
  return low + t * (map_.exact({i * kStep_m, (j + 1) * kStep_m}) - low);
}

glm::dvec2 AnchorMap::Row::at(double x_m) {
  if (!map_.anchor_) return {x_m, z_m_};
  const double i = std::floor(x_m / kStep_m);
  if (!known_ || i != first_) {
    left_ = known_ && i == first_ + 1 ? right_ : column(i);
    right_ = column(i + 1);
    first_ = i;
    known_ = true;
  }
  return left_ + (x_m / kStep_m - i) * (right_ - left_);
}

}  // namespace obliq
