#pragma once
// Small scenes for tests, and where real data is.
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/radar/render.h"
#include "server/scene/scene.h"
#include "terrain/world.h"
#include "tests/support/radar_settings.h"

namespace obliq::test {

/// The shared data folder: $OBLIQ_SHARED, else `shared` beside the project's root. May not exist.
inline std::filesystem::path shared_data() {
  if (const char* set = std::getenv("OBLIQ_SHARED")) return std::filesystem::path(set) / "data";
  return std::filesystem::path(OBLIQ_SOURCE_DIR).parent_path() / "shared" / "data";
}

inline std::vector<Material> two_materials() {
  Material terrain;
  terrain.name = "terrain";
  Material building;
  building.name = "building";
  building.model = ScatteringModel::geometric_optics;
  building.gamma = 0.1;
  return {terrain, building};
}

inline WorldSpec synthetic_spec(SyntheticKind kind, double reach_m, double cell_m) {
  WorldSpec spec;
  spec.terrain.synthetic = kind;
  spec.terrain.cell_m = cell_m;
  spec.radius_factor = std::numeric_limits<double>::infinity();
  spec.origin = {-99.5, 33.0};
  spec.reaches = {{spec.origin, reach_m}};
  return spec;
}

inline std::shared_ptr<const Scene> make_scene(World world, std::vector<Material> materials = two_materials(),
                                               RayMethod rays = RayMethod::march) {
  return std::make_shared<const Scene>(std::make_shared<const World>(std::move(world)), std::move(materials),
                                       0, rays);
}

inline SettingsPtr snapshot(const RadarSettings& settings) {
  return std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1});
}

/// Of few pixels and bins, 2 to 8 km away.
inline SettingsPtr small_settings(FrustumKind kind) {
  return snapshot(radar_settings(kind, {2000, 8000}, {32, 32}, {64, 64}));
}

/// Made once in a process.
inline std::shared_ptr<const Scene> level_ground() {
  static const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::flat, 9000, 100)));
  return scene;
}
/// Made once for each density.
inline std::shared_ptr<const Scene> hills_with_houses(double per_km2) {
  static std::map<double, std::shared_ptr<const Scene>> scenes;
  std::shared_ptr<const Scene>& scene = scenes[per_km2];
  if (scene) return scene;
  WorldSpec spec = synthetic_spec(SyntheticKind::hills, 9000, 60);
  spec.terrain.shape.height_m = 150;
  PrismSpec houses;
  houses.per_km2 = per_km2;
  spec.prisms = {houses};
  return scene = make_scene(load_world(spec));
}

/// An antenna over the origin of synthetic_spec, looking north.
inline PoseSettings settings_over_origin(double height_m, double bearing_deg = 0) {
  PoseSettings settings;
  settings.latitude_deg = 33.0;
  settings.longitude_deg = -99.5;
  settings.height_m = height_m;
  settings.bearing_deg = bearing_deg;
  return settings;
}
inline Pose pose_over_origin(const World& world, double height_m, double bearing_deg = 0) {
  std::vector<FieldError> errors;
  const auto pose = place_antenna(world, settings_over_origin(height_m, bearing_deg), errors);
  if (!pose) throw std::runtime_error(errors.front().text());
  return *pose;
}

}  // namespace obliq::test
