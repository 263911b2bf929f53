// buildings.corners and the permittivity of materials in scene files.
#include <gtest/gtest.h>

#include <cmath>

#include "server/control/sections/materials.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::corners_test {
namespace {

const std::string kTwoSources =
    std::string(kFlat) + "[[buildings]]\nsource = 'a.shp'\n[[buildings]]\nsource = 'b.shp'\n";

const Material& building(const SceneConfig& config) {
  return config.materials.at(*find_material(config.materials, "building"));
}

TEST_F(SceneFile, CornersAreOffAndAFloorStandsForThem) {
  const SceneConfig config = read(kTwoSources);
  EXPECT_FALSE(config.world.corners);
  EXPECT_NEAR(building(config).gamma, 1, 1e-12);
  EXPECT_EQ(building(config).permittivity_re, 5.3);
  EXPECT_EQ(building(config).permittivity_im, 0.3);
  EXPECT_EQ(config.materials[0].permittivity_re, 6);
  EXPECT_EQ(config.materials[0].permittivity_im, 0.6);
}

TEST_F(SceneFile, CornersAreOneSwitchForAllBuildingsAndLowerTheFloor) {
  const SceneConfig flag = read(kTwoSources, {"buildings.corners=true"});
  EXPECT_TRUE(flag.world.corners);
  EXPECT_EQ(flag.world.buildings.size(), 2u);
  EXPECT_EQ(flag.world.buildings[1].source.substr(flag.world.buildings[1].source.size() - 5), "b.shp");
  EXPECT_NEAR(building(flag).gamma, 0.1, 1e-12);
  const SceneConfig one = read(kTwoSources + "corners = true\n");  // of the second
  EXPECT_TRUE(one.world.corners && one.world.buildings[0].corners);
  const SceneConfig own =
      read(kTwoSources + "[materials.building]\ngamma_db = -3\n", {"buildings.corners=true"});
  EXPECT_NEAR(building(own).gamma, std::pow(10.0, -0.3), 1e-12);
}

TEST_F(SceneFile, CornersOfPrismsStandInATableOfTheirOwn) {
  const std::string prisms = std::string(kFlat) + "[[prisms]]\nper_km2 = 10\n";
  for (const SceneConfig& config :
       {read(prisms + "[buildings]\ncorners = true\n"), read(prisms, {"buildings.corners=true"})}) {
    EXPECT_TRUE(config.world.corners);
    EXPECT_TRUE(config.world.buildings.empty());
    const SceneConfig again = read(print_config(config));
    EXPECT_TRUE(again.world.corners);
    EXPECT_EQ(building(again).gamma, building(config).gamma);
  }
  EXPECT_SAYS(complaint(prisms + "[buildings]\nmaterial = 'urban'\n"), "buildings.source");
}

TEST_F(SceneFile, PermittivityIsTwoNumbersWithoutSigns) {
  const std::string scene = std::string(kFlat) + "[materials.building]\npermittivity = ";
  EXPECT_EQ(building(read(scene + "[4, 0.05]\n")).permittivity_im, 0.05);
  for (const char* wrong : {"[5.3, -0.3]", "[0.5, 0.1]", "5.3", "[5.3]", "[5.3, 0.3, 1]", "'x'", "[nan, 0.1]",
                            "[5.3, inf]", "['a', 1]", "[]"}) {
    const std::string said = complaint(scene + wrong + "\n");
    EXPECT_SAYS(said, "materials.building.permittivity: found ");
    EXPECT_SAYS(said, "allowed: [e', e''], e' 1 to 1e6 and the loss e'' 0 to 1e9, both without a sign");
  }
  EXPECT_SAYS(complaint(scene + "[5.3, -0.3]\n"), "found [5.3, -0.3]");
}

}  // namespace
}  // namespace obliq::corners_test
