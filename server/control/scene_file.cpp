#include "server/control/scene_file.h"

#include <algorithm>
#include <limits>

#include "server/control/overrides.h"
#include "server/control/scene_sections.h"
#include "terrain/world.h"

namespace obliq {

namespace {

/// Where synthetic ground lies when no antenna says otherwise: the paper's Texas.
constexpr LonLat kSyntheticPlace{-99.5, 33.0};

/// Ground beyond what the radar reaches, so that it can move without running out of terrain.
constexpr double kReachMargin = 1.25;

/// The finest posting of the national elevation models (3DEP): finer ground than that is not to be had.
constexpr double kFinestFootprint_m = 1.0;

void place_radars(SceneConfig& config, const std::vector<MissingPosition>& missing) {
  if (missing.empty()) return;
  const bool synthetic = config.world.terrain.synthetic != SyntheticKind::none;
  const LonLat place = synthetic ? kSyntheticPlace : dem_centre(config.world.terrain);
  for (const MissingPosition& m : missing) {
    PoseSettings& pose = config.radars[m.radar].pose;
    if (m.latitude) pose.latitude_deg = place.latitude_deg;
    if (m.longitude) pose.longitude_deg = place.longitude_deg;
  }
}

/// How densely a radar samples the ground along range: the finer of its range bins and its pixel rows, both
/// taken as evenly spread over the swath, as the oblique and polar frusta do at the terrain's top. The sweep
/// has no rows; it sees whatever ground there is, and two cells a bin are as fine as rays are by default.
double sampling_footprint_m(const RadarSettings& s) {
  if (s.frustum == FrustumKind::sweep) return (s.r_max_m - s.r_min_m) / s.range_bins / 2;
  return (s.r_max_m - s.r_min_m) / std::max(s.range_bins, s.pixel_rows);
}

void tell_the_terrain(SceneConfig& config) {
  const auto place = [](const RadarConfig& radar) {
    return LonLat{radar.pose.longitude_deg, radar.pose.latitude_deg};
  };
  WorldSpec& world = config.world;
  world.origin = place(config.radars.front());
  double footprint_m = std::numeric_limits<double>::infinity();
  for (const RadarConfig& radar : config.radars) {
    world.reaches.push_back({place(radar), kReachMargin * radar.settings.r_max_m});
    footprint_m = std::min(footprint_m, sampling_footprint_m(radar.settings));
  }
  world.sampling_footprint_m = std::max(footprint_m, kFinestFootprint_m);
}

}  // namespace

SceneConfig load_scene_file(const std::filesystem::path& path, const LoadOptions& options) {
  SceneConfig config;
  config.path = path;
  config.name = path.stem().string();

  ConfigNode root = parse_config_file(path);
  Complaints complaints;
  apply_overrides(root, options.set, complaints);

  SectionReader top(root, "", complaints);
  SceneReading reading{config, top, complaints, std::filesystem::absolute(path).parent_path()};
  read_scene_entries(reading);
  read_materials(reading);
  read_buildings(reading);
  read_prisms(reading);
  read_surfaces(reading);
  const std::vector<MissingPosition> missing = read_radars(reading);
  top.finish();
  complaints.throw_if_any();

  place_radars(config, missing);
  tell_the_terrain(config);
  return config;
}

}  // namespace obliq
