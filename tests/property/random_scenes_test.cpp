// The generator of random scenes gives legal scenes, the same for the same seed, and all kinds of them.
#include "tests/support/random_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "server/radar/profile/roofs.h"
#include "tests/support/scenes.h"

namespace obliq::random_scenes_test {
namespace {

constexpr std::uint64_t kScenes = 500;

TEST(RandomScenes, AreWhatAWorldAndAPoseMustBe) {
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    SCOPED_TRACE(scene.text);
    const HeightGrid& grid = scene.world.grid;
    ASSERT_GE(grid.nx, 2);
    ASSERT_GE(grid.nz, 2);
    EXPECT_EQ(grid.x0_m, std::round(grid.x0_m * 32) / 32);
    EXPECT_EQ(grid.z0_m, std::round(grid.z0_m * 32) / 32);
    EXPECT_EQ(grid.cell_m, std::round(grid.cell_m * 32) / 32);
    const glm::dvec3& antenna = scene.pose.antenna.m;
    EXPECT_EQ(antenna.x, std::round(antenna.x * 1024) / 1024);
    EXPECT_FALSE(antenna.y <= grid.height_at_m(antenna.x, antenna.z));
    EXPECT_FALSE(roof_above(scene.world.buildings, antenna).has_value());
    EXPECT_GT(scene.settings.r_max_m, scene.settings.r_min_m);
    EXPECT_GE(scene.settings.pixel_columns, scene.settings.azimuth_bins);
  }
}

TEST(RandomScenes, AreTheSameForTheSameSeed) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const test::RandomScene a = test::random_scene(seed), b = test::random_scene(seed);
    EXPECT_EQ(a.text, b.text);
    ASSERT_EQ(a.world.grid.y_m.size(), b.world.grid.y_m.size());
    EXPECT_EQ(std::memcmp(a.world.grid.y_m.data(), b.world.grid.y_m.data(),
                          a.world.grid.y_m.size() * sizeof(float)),
              0);
    EXPECT_EQ(a.world.buildings.ring_xz_m, b.world.buildings.ring_xz_m);
    EXPECT_NE(a.text, test::random_scene(seed + 1).text);
  }
}

TEST(RandomScenes, AreOfEveryKindAndMostShowSomething) {
  std::map<std::string, int> kinds;
  int lit = 0, shadowed = 0;
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    const RadarSettings settings = random.settings;
    const Pose pose = random.pose;
    const World& world = random.world;
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    bool voids = false;
    for (const float y : world.grid.y_m) {
      voids |= std::isnan(y);
      if (!std::isnan(y)) lowest = std::min<double>(lowest, y), highest = std::max<double>(highest, y);
    }
    kinds["flat"] += highest - lowest < 1e-3 ? 1 : 0;
    kinds["with voids"] += voids ? 1 : 0;
    kinds["with prisms"] += world.buildings.list.empty() ? 0 : 1;
    kinds["antenna below the peaks"] += pose.antenna.m.y < highest ? 1 : 0;
    kinds["antenna outside the grid"] += std::isnan(pose.ground_y_m) ? 1 : 0;
    kinds["whole circle"] += settings.sector_deg == 360 ? 1 : 0;
    kinds["curved earth"] += std::isfinite(world.frame.radius_factor()) ? 1 : 0;
    kinds["far from the origin"] += std::abs(world.grid.x0_m) > 5e4 ? 1 : 0;
    SCOPED_TRACE(random.text);
    const auto scene = test::make_scene(std::move(random.world));
    const Frame frame = render(scene, test::snapshot(settings), pose, {0, settings.azimuth_bins});
    bool any_lit = false, any_shadow = false;
    for (const std::uint8_t state : frame.bins.state) {
      any_lit |= state == static_cast<std::uint8_t>(BinState::sampled);
      any_shadow |= state == static_cast<std::uint8_t>(BinState::shadow);
    }
    lit += any_lit ? 1 : 0;
    shadowed += any_shadow ? 1 : 0;
  }
  for (const auto& [kind, count] : kinds) {
    std::printf("    %s: %d of %d\n", kind.c_str(), count, static_cast<int>(kScenes));
    EXPECT_GE(count, static_cast<int>(kScenes) / 25) << kind;
  }
  std::printf("    with samples: %d; with shadow: %d\n", lit, shadowed);
  EXPECT_GE(lit, static_cast<int>(kScenes) * 3 / 4);
  EXPECT_GE(shadowed, static_cast<int>(kScenes) / 5);
}

}  // namespace
}  // namespace obliq::random_scenes_test
