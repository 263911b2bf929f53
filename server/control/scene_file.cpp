#include "server/control/scene_file.h"

#include "server/control/overrides.h"
#include "server/control/sections/materials.h"
#include "server/control/sections/section.h"
#include "server/control/terrain_reach.h"
#include "terrain/world.h"

namespace obliq {

namespace {

/// Where synthetic ground lies when no antenna says otherwise: the paper's Texas.
constexpr LonLat kSyntheticPlace{-99.5, 33.0};

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

SceneConfig load(ConfigNode root, const std::filesystem::path& path, const LoadOptions& options) {
  SceneConfig config;
  config.path = path;
  config.name = path.stem().string();

  Complaints complaints;
  apply_overrides(root, options.set, complaints);

  SectionReader top(root, "", complaints);
  SceneReading scene{config, top, complaints, std::filesystem::absolute(path).parent_path()};
  read_sections(scene);
  read_materials(scene);
  read_list(scene, kBuildings);
  read_list(scene, kPrisms);
  read_list(scene, kSurfaces);
  const std::vector<MissingPosition> missing = read_radars(scene);
  top.finish();
  complaints.throw_if_any();

  place_radars(config, missing);
  set_terrain_reach(config);
  return config;
}

}  // namespace

SceneConfig load_scene_file(const std::filesystem::path& path, const LoadOptions& options) {
  return load(parse_config_file(path), path, options);
}

SceneConfig load_scene_text(const std::string& text, const std::filesystem::path& path,
                            const LoadOptions& options) {
  return load(parse_config_text(text, path.string()), path, options);
}

}  // namespace obliq
