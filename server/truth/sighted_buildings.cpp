#include "server/truth/sighted_buildings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/polygon.h"

namespace obliq {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Bearings are rounded; a building on a bin's edge is listed in both bins. Listing too many does no harm.
constexpr double kSlack_rad = 1e-9;

glm::dvec2 corner(const Buildings& buildings, std::uint32_t k) { return glm::dvec2(buildings.ring_xz_m[k]); }

double bearing_rad(const glm::dvec2& away) { return std::atan2(away.x, away.y); }

/// The corners [first, last) of a building's outline and holes.
struct Corners {
  std::uint32_t first, last;
  Corners(const Buildings& buildings, const Building& building)
      : first(buildings.ring_start[building.first_ring]),
        last(buildings.ring_start[building.first_ring + building.n_rings]) {}
};

}  // namespace

SightedBuildings::SightedBuildings(const Buildings& buildings, const ReferenceView& view, int first_azimuth,
                                   int n_azimuth)
    : buildings_(buildings),
      view_(view),
      antenna_m_(view.antenna_m),
      first_azimuth_(first_azimuth),
      by_bin_(static_cast<std::size_t>(n_azimuth)) {
  for (std::uint32_t b = 0; b < buildings.list.size(); ++b) sort_in(b);
}

void SightedBuildings::sort_in(std::uint32_t building) {
  const Corners corners(buildings_, buildings_.list[building]);
  const glm::dvec2 here(antenna_m_.x, antenna_m_.z);
  Rect box;
  for (std::uint32_t k = corners.first; k < corners.last; ++k) box.include(corner(buildings_, k));
  const glm::dvec2 nearest(std::clamp(here.x, box.x0_m, box.x1_m), std::clamp(here.y, box.z0_m, box.z1_m));
  if (std::hypot(nearest.x - here.x, nearest.y - here.y) > view_.r_max_m) return;
  if (nearest == here) {
    for (auto& bin : by_bin_) bin.push_back(building);
    return;
  }
  // The box, and so the building, subtends less than half a turn.
  const double first = bearing_rad(corner(buildings_, corners.first) - here);
  double least = 0, greatest = 0;
  for (std::uint32_t k = corners.first; k < corners.last; ++k) {
    const double off = std::remainder(bearing_rad(corner(buildings_, k) - here) - first, kTurn);
    least = std::min(least, off);
    greatest = std::max(greatest, off);
  }
  const double width_rad = view_.sector_rad / view_.azimuth_bins;
  const double from = from_start_rad(first + least - kSlack_rad);
  const double to = from + greatest - least + 2 * kSlack_rad;
  const int last_bin = static_cast<int>(by_bin_.size()) - 1;
  // A building across the sector's start begins at its end, a turn earlier.
  int listed = -1;
  for (const double turn : {kTurn, 0.0}) {
    const int low = static_cast<int>(std::floor((from - turn) / width_rad)) - first_azimuth_;
    const int high = static_cast<int>(std::floor((to - turn) / width_rad)) - first_azimuth_;
    for (int a = std::max(low, listed + 1); a <= std::min(high, last_bin); ++a) {
      by_bin_[static_cast<std::size_t>(a)].push_back(building);
      listed = a;
    }
  }
}

double SightedBuildings::from_start_rad(double bearing) const {
  const double off = std::remainder(bearing - (view_.bearing_rad - view_.sector_rad / 2), kTurn);
  return off < 0 ? off + kTurn : off;
}

std::vector<double> SightedBuildings::corner_bearings_rad(int azimuth) const {
  const glm::dvec2 here(antenna_m_.x, antenna_m_.z);
  const double width_rad = view_.sector_rad / view_.azimuth_bins;
  std::vector<double> bearings;
  for (const std::uint32_t b : in_bin(azimuth)) {
    const Corners corners(buildings_, buildings_.list[b]);
    for (std::uint32_t k = corners.first; k < corners.last; ++k) {
      const double at = from_start_rad(bearing_rad(corner(buildings_, k) - here));
      if (at > azimuth * width_rad && at < (azimuth + 1) * width_rad) bearings.push_back(at);
    }
  }
  std::sort(bearings.begin(), bearings.end());
  return bearings;
}

bool SightedBuildings::cross(std::uint32_t building, const AzimuthPlane& plane, std::size_t owner,
                             std::vector<OutlineCrossing>& crossings) const {
  const Building& b = buildings_.list[building];
  const long double s = plane.sin_bearing;
  const long double c = plane.cos_bearing;
  bool antenna_inside = false;
  for (std::uint32_t ring = b.first_ring; ring < b.first_ring + b.n_rings; ++ring) {
    const std::uint32_t first = buildings_.ring_start[ring];
    const std::uint32_t last = buildings_.ring_start[ring + 1];
    for (std::uint32_t k = first; k < last; ++k) {
      const glm::dvec2 p = corner(buildings_, k);
      const glm::dvec2 q = corner(buildings_, k + 1 < last ? k + 1 : first);
      const long double px = p.x - antenna_m_.x, pz = p.y - antenna_m_.z;
      const long double qx = q.x - antenna_m_.x, qz = q.y - antenna_m_.z;
      // Distances right of the plane. A corner on it counts as right of it, in both of its edges.
      const long double p_right = px * c - pz * s;
      const long double q_right = qx * c - qz * s;
      if ((p_right >= 0) == (q_right >= 0)) continue;
      const long double along_p = px * s + pz * c;
      const long double along_q = qx * s + qz * c;
      const long double d = along_p + p_right / (p_right - q_right) * (along_q - along_p);
      if (!(d > 0)) {
        antenna_inside = !antenna_inside;
        continue;
      }
      const long double length = std::hypot(qx - px, qz - pz);
      const long double side = q_right > p_right ? 1 : -1;  // the normal's, of (qz - pz, px - qx)
      crossings.push_back({d, static_cast<double>(std::fabs(q_right - p_right) / length),
                           static_cast<double>(side * (qz - pz) / length),
                           static_cast<double>(side * (px - qx) / length), owner});
    }
  }
  return antenna_inside;
}

}  // namespace obliq
