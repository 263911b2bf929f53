#include "server/flight/window.h"

#include <algorithm>
#include <cmath>

#include "server/control/scene_file.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

/// The origin moves with a window that is built anyway from this share of reorigin_km on.
constexpr double kEarlyOrigin = 0.75;
/// A window is due when this share of its margin is used up.
constexpr double kDueMargin = 0.5;
/// A new one is laid ahead by at most this share: the radar has to be in it all the time, and a radar that
/// stops has not used up what makes the next one due.
constexpr double kMostAhead = 0.45;
/// Radars of short range get this much more ground, or they would leave it within seconds.
constexpr double kLeastMargin_m = 1000;

constexpr double kEarthRadius_m = 6371008.8;  // mean of WGS84's semi-axes, (2 a + b) / 3

double reach_limit_m(const SceneConfig& config) {
  double limit_m = config.flight.max_reach_km * 1000;
  if (limit_m > 0) return limit_m;
  for (const RadarConfig& radar : config.radars) limit_m = std::max(limit_m, radar.settings.r_max_m);
  return limit_m;
}

double counted_range_m(const SceneConfig& config, const RadarPlace& radar) {
  return std::min(radar.r_max_m, reach_limit_m(config));
}

double next_radius_m(double range_m) { return std::max(loaded_radius_m(range_m), range_m + kLeastMargin_m); }

/// From here towards there, as far as the next window can be laid ahead.
LonLat within_reach(const LonLat& here, const LonLat& there, double range_m) {
  const double most_m = kMostAhead * (next_radius_m(range_m) - range_m);
  const double far_m = distance_m(here, there);
  return far_m > most_m ? towards(here, there, most_m / far_m) : there;
}

/// Whether the reach holds all that is seen from a place, with a share of the margin left.
bool covers(const Reach& reach, const LonLat& place, double range_m, double share_left) {
  const double margin_m = reach.radius_m - range_m;
  return margin_m > 0 && distance_m(reach.centre, place) <= (1 - share_left) * margin_m;
}

}  // namespace

double distance_m(const LonLat& a, const LonLat& b) {
  // Haversine: no cancellation for neighbours.
  const double d_lat = (b.latitude_deg - a.latitude_deg) * kDegree_rad;
  const double d_lon = (b.longitude_deg - a.longitude_deg) * kDegree_rad;
  const double s_lat = std::sin(d_lat / 2);
  const double s_lon = std::sin(d_lon / 2);
  const double h = s_lat * s_lat + std::cos(a.latitude_deg * kDegree_rad) *
                                       std::cos(b.latitude_deg * kDegree_rad) * s_lon * s_lon;
  return 2 * kEarthRadius_m * std::asin(std::min(1.0, std::sqrt(h)));
}

SceneWindow window_of(const SceneConfig& config) { return {config.world.origin, config.world.reaches}; }

bool is_same(const SceneWindow& a, const SceneWindow& b) {
  const auto same_place = [](const LonLat& p, const LonLat& q) {
    return p.longitude_deg == q.longitude_deg && p.latitude_deg == q.latitude_deg;
  };
  return same_place(a.origin, b.origin) &&
         std::ranges::equal(a.reaches, b.reaches, [&](const Reach& p, const Reach& q) {
           return same_place(p.centre, q.centre) && p.radius_m == q.radius_m;
         });
}

SceneConfig aimed_at(const SceneConfig& config, const SceneWindow& window) {
  SceneConfig aimed = config;
  SyntheticSpec& shape = aimed.world.terrain.shape;
  if (!shape.anchor) shape.anchor = config.world.origin;
  aimed.world.origin = window.origin;
  aimed.world.reaches = window.reaches;
  return aimed;
}

LonLat towards(const LonLat& from, const LonLat& to, double share) {
  const double east_deg = std::remainder(to.longitude_deg - from.longitude_deg, 360.0);
  return {std::remainder(from.longitude_deg + share * east_deg, 360.0),
          std::clamp(from.latitude_deg + share * (to.latitude_deg - from.latitude_deg), -90.0, 90.0)};
}

SceneWindow next_window(const SceneConfig& config, const SceneWindow& current,
                        std::span<const RadarPlace> radars, std::span<const RadarPlace> ahead) {
  SceneWindow next = current;
  if (radars.empty()) return next;
  const double reorigin_m = config.flight.reorigin_km * 1000;
  if (distance_m(radars.front().position, current.origin) >= kEarlyOrigin * reorigin_m)
    next.origin = radars.front().position;
  next.reaches.clear();
  for (std::size_t i = 0; i < radars.size(); ++i) {
    const double range_m = counted_range_m(config, radars[i]);
    const LonLat& here = radars[i].position;
    const LonLat& there = i < ahead.size() ? ahead[i].position : here;
    next.reaches.push_back({within_reach(here, there, range_m), next_radius_m(range_m)});
  }
  return next;
}

bool needs_next_window(const SceneConfig& config, const SceneWindow& current,
                       std::span<const RadarPlace> radars, std::span<const RadarPlace> ahead) {
  if (!config.flight.enabled || radars.empty()) return false;
  if (distance_m(radars.front().position, current.origin) > config.flight.reorigin_km * 1000) return true;
  if (!config.world.terrain.area.empty()) return false;
  for (std::size_t i = 0; i < radars.size(); ++i) {
    const double range_m = counted_range_m(config, radars[i]);
    const auto covered = [&](const LonLat& place, double share_left) {
      return std::ranges::any_of(
          current.reaches, [&](const Reach& reach) { return covers(reach, place, range_m, share_left); });
    };
    const LonLat& here = radars[i].position;
    const LonLat& there = i < ahead.size() ? ahead[i].position : here;
    if (!covered(here, 0) || !covered(within_reach(here, there, range_m), 1 - kDueMargin)) return true;
  }
  return false;
}

double window_posts(const SceneWindow& window, double cell_m) {
  // Degrees of latitude and longitude at each reach's own latitude: near enough for a limit.
  const double degree_m = kEarthRadius_m * kDegree_rad;
  double west_m = HUGE_VAL, east_m = -HUGE_VAL, south_m = HUGE_VAL, north_m = -HUGE_VAL;
  for (const Reach& reach : window.reaches) {
    const double lon_deg = std::remainder(reach.centre.longitude_deg - window.origin.longitude_deg, 360.0);
    const double x_m = lon_deg * degree_m * std::cos(reach.centre.latitude_deg * kDegree_rad);
    const double z_m = (reach.centre.latitude_deg - window.origin.latitude_deg) * degree_m;
    west_m = std::min(west_m, x_m - reach.radius_m);
    east_m = std::max(east_m, x_m + reach.radius_m);
    south_m = std::min(south_m, z_m - reach.radius_m);
    north_m = std::max(north_m, z_m + reach.radius_m);
  }
  if (!(west_m <= east_m && south_m <= north_m)) return 0;
  return (east_m - west_m) / cell_m * ((north_m - south_m) / cell_m);
}

void Speedometer::note(std::span<const RadarPlace> radars, Time now) {
  heard_ = now;
  const double elapsed_s = to_seconds(now - since_);
  const bool comparable = to_.size() == radars.size();
  if (comparable && elapsed_s < 0.5) return;
  from_ = to_;
  elapsed_s_ = comparable ? elapsed_s : 0;
  to_.assign(radars.begin(), radars.end());
  since_ = now;
}

std::vector<RadarPlace> Speedometer::ahead(std::span<const RadarPlace> radars, double later_s,
                                           Time now) const {
  std::vector<RadarPlace> places(radars.begin(), radars.end());
  if (now - heard_ > kStandsAfter || elapsed_s_ <= 0 || from_.size() != places.size()) return places;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LonLat& from = from_[i].position;
    const LonLat moved = towards(from, to_[i].position, later_s / elapsed_s_);
    LonLat& at = places[i].position;
    at = {at.longitude_deg + moved.longitude_deg - from.longitude_deg,
          at.latitude_deg + moved.latitude_deg - from.latitude_deg};
  }
  return places;
}

}  // namespace obliq
