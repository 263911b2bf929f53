// The scene files of deploy/scenes are accepted, and the files they name that ship with them exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "server/control/scene_file.h"

namespace obliq::shipped_scenes_test {
namespace {

std::vector<std::filesystem::path> shipped_scenes() {
  std::vector<std::filesystem::path> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(OBLIQ_SCENES))
    if (entry.path().extension() == ".toml") scenes.push_back(entry.path());
  std::ranges::sort(scenes);
  return scenes;
}

TEST(ShippedScenes, AreAcceptedAndNameFilesThatShipWithThem) {
  ASSERT_GE(shipped_scenes().size(), 4u);
  for (const std::filesystem::path& path : shipped_scenes()) {
    SCOPED_TRACE(path.filename());
    const SceneConfig scene = load_scene_file(path);
    const bool is_to_look_at = path.filename() != "targets_check.toml";  // that one is for a sum by hand
    for (const RadarConfig& radar : scene.radars) {
      EXPECT_TRUE(radar.settings.frustum == FrustumKind::oblique ||
                  radar.settings.frustum == FrustumKind::sweep);
      EXPECT_TRUE(!is_to_look_at || radar.settings.range_normalisation ||
                  radar.settings.beam.elevation == ElevationPattern::cosecant)
          << "far ground would be dark";
    }
    const bool is_bare = path.filename() == "mountain_radar.toml" || path.filename() == "harbour.toml";
    EXPECT_EQ(scene.world.prisms.size(), is_bare || !is_to_look_at ? 0u : 1u);
    for (const PrismSpec& prisms : scene.world.prisms)
      EXPECT_TRUE(prisms.within.empty() || std::filesystem::is_regular_file(prisms.within)) << prisms.within;
    for (const SurfaceSpec& surface : scene.world.surfaces)
      EXPECT_TRUE(std::filesystem::is_regular_file(surface.source)) << surface.source;
    const TerrainSpec& terrain = scene.world.terrain;
    EXPECT_EQ(terrain.dem.empty(), terrain.synthetic != SyntheticKind::none);
  }
}

}  // namespace
}  // namespace obliq::shipped_scenes_test
