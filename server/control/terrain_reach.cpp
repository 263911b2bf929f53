#include "server/control/terrain_reach.h"

#include <algorithm>
#include <limits>

namespace obliq {
namespace {

constexpr double kReachMargin = 1.25;

/// Automatic cells leave room for the windows of a flight, two of which are in memory at times.
constexpr double kAutoShare = 4;

/// The finest posting of the national elevation models (3DEP): finer ground than that is not to be had.
constexpr double kFinestFootprint_m = 1.0;

/// How densely a radar samples the ground along range: the finer of its range bins and its pixel rows, both
/// taken as evenly spread over the swath, as the oblique and polar frusta do at the terrain's top. The sweep
/// has no rows; it sees whatever ground there is, and two cells a bin are as fine as rays are by default.
double sampling_footprint_m(const RadarSettings& s) {
  if (s.frustum == FrustumKind::sweep) return (s.r_max_m - s.r_min_m) / s.range_bins / 2;
  return (s.r_max_m - s.r_min_m) / std::max(s.range_bins, s.pixel_rows);
}

}  // namespace

double loaded_radius_m(double r_max_m) { return kReachMargin * r_max_m; }

void set_terrain_reach(SceneConfig& config) {
  WorldSpec& world = config.world;
  const auto place = [](const RadarConfig& radar) {
    return LonLat{radar.pose.longitude_deg, radar.pose.latitude_deg};
  };
  world.origin = place(config.radars.front());
  world.reaches.clear();
  double footprint_m = std::numeric_limits<double>::infinity();
  for (const RadarConfig& radar : config.radars) {
    world.reaches.push_back({place(radar), loaded_radius_m(radar.settings.r_max_m)});
    footprint_m = std::min(footprint_m, sampling_footprint_m(radar.settings));
  }
  world.terrain.most_auto_posts = config.flight.max_megaposts * 1e6 / kAutoShare;
  world.sampling_footprint_m = std::max(footprint_m, kFinestFootprint_m);
}

}  // namespace obliq
