#include "terrain/buildings/placement.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/units.h"

namespace obliq {
namespace {

WorldPoint world_point(const WorldFrame& frame, const LonLat& p, double height_m) {
  return frame.world_from_geodetic({p.latitude_deg * kDegree_rad, p.longitude_deg * kDegree_rad, height_m});
}

bool on_grid(const HeightGrid& grid, const glm::dvec3& m) {
  return m.x >= grid.x0_m && m.x <= grid.x1_m() && m.z >= grid.z0_m && m.z <= grid.z1_m();
}

}  // namespace

GroundPlace place_on_ground(const World& world, const LonLat& position) {
  GroundPlace place;
  if (!std::isfinite(position.longitude_deg) || !(std::abs(position.latitude_deg) <= 90)) return place;
  // Each round leaves x / R of the slope times the error: at 100 km, 1.6 % on a 45 degree slope.
  for (int round = 0; round < 4; ++round) {
    place.point = world_point(world.frame, position, place.height_m);
    glm::dvec3& m = place.point.m;
    if (!on_grid(world.grid, m)) {
      place.state = GroundState::off_grid;
      return place;
    }
    const double y_m = world.grid.height_at_m(m.x, m.z);
    if (std::isnan(y_m)) {
      place.state = GroundState::unknown;
      return place;
    }
    place.state = GroundState::known;
    m.y = y_m;
    const double height_m = world.frame.geodetic_from_world(place.point).height_m;
    const bool settled = std::abs(height_m - place.height_m) < 0.1;
    place.height_m = height_m;
    if (settled) break;
  }
  return place;
}

Polygon world_polygon(const WorldFrame& frame, const GeoPolygon& polygon, double height_m) {
  Polygon result;
  for (const auto& ring : polygon.rings) {
    Ring& to = result.rings.emplace_back();
    to.reserve(ring.size());
    for (const LonLat& p : ring) {
      const WorldPoint w = world_point(frame, p, height_m);
      to.emplace_back(w.m.x, w.m.z);
    }
  }
  return result;
}

GeoWindow geo_window(const World& world) {
  const HeightGrid& grid = world.grid;
  const double origin_deg = world.frame.origin_longitude_rad() / kDegree_rad;
  GeoWindow w{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
  constexpr int kSide = 16;
  for (int k = 0; k <= kSide; ++k) {
    const double t = static_cast<double>(k) / kSide;
    for (const auto& [s, v] : {std::pair{t, 0.0}, {t, 1.0}, {0.0, t}, {1.0, t}}) {
      const double x_m = grid.x0_m + s * (grid.x1_m() - grid.x0_m);
      const double z_m = grid.z0_m + v * (grid.z1_m() - grid.z0_m);
      const double y_m = world.frame.ellipsoid_y_m(x_m, z_m) - world.frame.lift_m(x_m, z_m);
      const Geodetic g = world.frame.geodetic_from_world(WorldPoint{glm::dvec3(x_m, y_m, z_m)});
      double longitude_deg = g.longitude_rad / kDegree_rad;
      longitude_deg += 360 * std::round((origin_deg - longitude_deg) / 360);
      const double latitude_deg = g.latitude_rad / kDegree_rad;
      w.south_west.longitude_deg = std::min(w.south_west.longitude_deg, longitude_deg);
      w.south_west.latitude_deg = std::min(w.south_west.latitude_deg, latitude_deg);
      w.north_east.longitude_deg = std::max(w.north_east.longitude_deg, longitude_deg);
      w.north_east.latitude_deg = std::max(w.north_east.latitude_deg, latitude_deg);
    }
  }
  // Sides bulge between the samples by 1/256 of their sagitta, and high ground leans outwards.
  constexpr double kSlack_deg = 0.002;
  w.south_west.longitude_deg -= kSlack_deg;
  w.south_west.latitude_deg -= kSlack_deg;
  w.north_east.longitude_deg += kSlack_deg;
  w.north_east.latitude_deg += kSlack_deg;
  return w;
}

}  // namespace obliq
