// The scene files of deploy/scenes are accepted, and the files they name that ship with them exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "server/control/scene_file.h"

namespace obliq {
namespace {

std::vector<std::filesystem::path> shipped_scenes() {
  std::vector<std::filesystem::path> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(OBLIQ_SCENES))
    if (entry.path().extension() == ".toml") scenes.push_back(entry.path());
  std::ranges::sort(scenes);
  return scenes;
}

class ShippedScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(ShippedScene, IsAccepted) {
  const SceneConfig scene = load_scene_file(GetParam());
  ASSERT_EQ(scene.radars.size(), 1u);
  EXPECT_EQ(scene.radars[0].settings.frustum, FrustumKind::oblique);
  EXPECT_TRUE(scene.radars[0].settings.range_normalisation);
  ASSERT_EQ(scene.world.prisms.size(), 1u);
}

TEST_P(ShippedScene, NamesTownsThatShipWithIt) {
  const SceneConfig scene = load_scene_file(GetParam());
  const std::string& within = scene.world.prisms.at(0).within;
  EXPECT_TRUE(within.empty() || std::filesystem::is_regular_file(within)) << within;
}

TEST_P(ShippedScene, StandsOnAnElevationModelOrOnMadeUpGround) {
  const TerrainSpec terrain = load_scene_file(GetParam()).world.terrain;
  EXPECT_EQ(terrain.dem.empty(), terrain.synthetic != SyntheticKind::none);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShippedScene, testing::ValuesIn(shipped_scenes()),
                         [](const auto& scene) { return scene.param.stem().string(); });

}  // namespace
}  // namespace obliq
