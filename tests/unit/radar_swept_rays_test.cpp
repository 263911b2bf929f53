// Rays that one march answers for a whole plane: alone and side by side, at voids, roofs and the antenna's
// foot.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "server/radar/profile/profile_rays.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

/// As many planes as go side by side, of 300 rays each, over all buildings of a random scene.
struct RaysOfARandomScene {
  explicit RaysOfARandomScene(std::uint64_t seed) {
    test::RandomScene random = test::random_scene(seed);
    antenna = random.pose.antenna.m;
    scene = test::scene_of(random);
    buildings.resize(scene->world().buildings.list.size());
    for (std::uint32_t b = 0; b < buildings.size(); ++b) buildings[b] = b;
    for (int k = -150; k < 150; ++k) elevation.push_back(sincos_turns(k / (200 * M_PI)));
    for (int k = 0; k < ProfileRays::kMostProfiles; ++k) bearings.push_back(sincos_turns(0.37 * k));
  }

  glm::dvec3 antenna;
  std::shared_ptr<const Scene> scene;
  std::vector<std::uint32_t> buildings;
  std::vector<SinCos> elevation;
  std::vector<SinCos> bearings;
};

TEST(ProfileRays, MeetTheGroundRightUnderAnAntennaThatIsOverADiagonal) {
  // Far ground above it, so that marches begin at its foot.
  const auto scene =
      test::make_scene(test::made_world(20, 1, [](double x_m, double) { return x_m > 15 ? 2.0 : 0.0; }));
  const glm::dvec3 antenna(3.25, 0.5, 4.75);
  std::vector<SinCos> elevation;
  for (int k = 1; k < 40; ++k) elevation.push_back(sincos_turns(-0.25 + k / 200.0));
  std::vector<double> range_m(elevation.size());
  std::vector<std::uint32_t> surface(elevation.size());
  for (int turn = 0; turn < 64; ++turn) {
    const SinCos bearing = sincos_turns(turn / 64.0);
    ProfileRays(*scene, antenna, elevation, HUGE_VAL).answer(std::span(&bearing, 1), {}, range_m, surface);
    for (std::size_t k = 0; k < elevation.size(); ++k) {
      EXPECT_LT(surface[k], ProfileRays::kFace) << turn << ", " << k;
      EXPECT_NEAR(range_m[k], -antenna.y / elevation[k].sin, 1e-12) << turn << ", " << k;
    }
  }
}

TEST(ProfileRays, AnswerAlikeInEveryInstructionSetAloneAndSideBySide) {
  int hits = 0;
  for (std::uint64_t seed = 500; seed < 540; ++seed) {
    const RaysOfARandomScene given(seed);
    const auto& [antenna, scene, buildings, elevation, bearings] = given;
    const std::size_t n = elevation.size();
    std::vector<double> expected_m(bearings.size() * n), found_m(bearings.size() * n);
    std::vector<std::uint32_t> expected(bearings.size() * n), found(bearings.size() * n);
    const ProfileRays rays(*scene, antenna, elevation, HUGE_VAL);
    for (std::size_t k = 0; k < bearings.size(); ++k)
      rays.answer(std::span(bearings).subspan(k, 1), buildings, std::span(expected_m).subspan(k * n, n),
                  std::span(expected).subspan(k * n, n));
    for (const Kernels& kernels : all_kernels()) {
      ProfileRays(*scene, antenna, elevation, HUGE_VAL, kernels).answer(bearings, buildings, found_m, found);
      EXPECT_EQ(found_m, expected_m) << kernels.name << " seed " << seed;
      EXPECT_EQ(found, expected) << kernels.name << " seed " << seed;
    }
    for (const std::uint32_t surface : expected) hits += surface != ProfileRays::kNothing ? 1 : 0;
  }
  EXPECT_GT(hits, 10000);
}

TEST(ProfileRays, AnswerARunOfTheirsAsTheyAnswerItAmongAll) {
  int hits = 0;
  for (std::uint64_t seed = 700; seed < 780; ++seed) {
    const RaysOfARandomScene given(seed);
    const auto& [antenna, scene, buildings, elevation, bearings] = given;
    const std::size_t n = elevation.size();
    std::vector<double> whole_m(bearings.size() * n);
    std::vector<std::uint32_t> whole(bearings.size() * n);
    const ProfileRays rays(*scene, antenna, elevation, HUGE_VAL);
    rays.answer(bearings, buildings, whole_m, whole);
    for (const ProfileRays::Run run : {ProfileRays::Run{0, 7}, {7, 1}, {8, 140}, {148, 151}, {299, 1}}) {
      std::vector<double> some_m(bearings.size() * run.count);
      std::vector<std::uint32_t> some(some_m.size());
      rays.answer(bearings, buildings, run, some_m, some);
      for (std::size_t k = 0; k < some.size(); ++k) {
        const std::size_t at = k / run.count * n + run.first + k % run.count;
        ASSERT_EQ(some_m[k], whole_m[at]) << "seed " << seed << ", ray " << run.first + k % run.count;
        ASSERT_EQ(some[k], whole[at]) << "seed " << seed << ", ray " << run.first + k % run.count;
        hits += some[k] != ProfileRays::kNothing ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hits, 10000);
}

TEST(ProfileRays, AnswerBehindAVoidWhereverItBegins) {
  // One plane runs along a line of the grid, where triangles have no extent, and the others beside it: a cell
  // behind the void has as much to note as a cell can have, at every state of the lists that notes fill.
  std::vector<SinCos> bearings;
  for (int k = -3; k < 5; ++k) bearings.push_back({-std::sqrt(1 - 1e-6 * k * k), 1e-3 * k});
  std::vector<SinCos> elevation;
  for (double slope = -0.97941; slope < -100 / 850.0; slope += 0.003)
    elevation.push_back({slope / std::hypot(1, slope), 1 / std::hypot(1, slope)});
  const std::size_t n = elevation.size();
  std::vector<double> expected_m(bearings.size() * n), found_m(bearings.size() * n);
  std::vector<std::uint32_t> expected(bearings.size() * n), found(bearings.size() * n);
  int under = 0;
  for (double void_m = 200; void_m < 1800; void_m += 10) {
    const auto scene = test::make_scene(test::made_world(
        2000, 10, [&](double x_m, double) { return x_m == -void_m ? test::kUnknown : 0.0; }));
    const glm::dvec3 antenna(0, 100, 0);
    for (const Kernels& kernels : all_kernels()) {
      const ProfileRays rays(*scene, antenna, elevation, HUGE_VAL, kernels);
      for (std::size_t k = 0; k < bearings.size(); ++k)
        rays.answer(std::span(bearings).subspan(k, 1), {}, std::span(expected_m).subspan(k * n, n),
                    std::span(expected).subspan(k * n, n));
      rays.answer(bearings, {}, found_m, found);
      ASSERT_EQ(found_m, expected_m) << kernels.name << ", void at " << void_m;
      ASSERT_EQ(found, expected) << kernels.name << ", void at " << void_m;
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
      under += found[k] == ProfileRays::kUnder ? 1 : 0;
      if (found[k] == ProfileRays::kUnder || found[k] == ProfileRays::kNothing) continue;
      ASSERT_NEAR(found_m[k], -antenna.y / elevation[k % n].sin, 1e-9) << "flat ground";
    }
  }
  EXPECT_GT(under, 1000);
}

TEST(ProfileRays, EndWithinABuildingWhenTheirReachDoes) {
  int on_roofs = 0;
  for (std::uint64_t seed = 600; seed < 700; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    const glm::dvec3 antenna = random.pose.antenna.m;
    const auto scene = test::scene_of(random);
    const World& world = scene->world();
    for (std::uint32_t building = 0; building < world.buildings.list.size(); ++building) {
      const glm::dvec3 to =
          world.buildings.faces[world.buildings.list[building].first_face].centre_m - antenna;
      const double centre_m = std::hypot(to.x, to.z);
      if (!(centre_m > 1)) continue;
      const SinCos bearing{to.x / centre_m, to.z / centre_m};
      const SinCos elevation = sincos_turns((std::atan2(to.y, centre_m) - 1e-3) / (2 * M_PI));
      double slant_range_m = 0;
      std::uint32_t surface = 0;
      // Through the middle of the roof, and where the reach ends just before, on and behind it.
      for (const double reach_m : {centre_m - 1e-9, centre_m, 1.001 * centre_m, HUGE_VAL}) {
        ProfileRays(*scene, antenna, std::span(&elevation, 1), reach_m)
            .answer(std::span(&bearing, 1), std::span(&building, 1), std::span(&slant_range_m, 1),
                    std::span(&surface, 1));
        on_roofs += surface != ProfileRays::kNothing && surface >= ProfileRays::kFace ? 1 : 0;
      }
    }
  }
  EXPECT_GT(on_roofs, 50);
}

}  // namespace
}  // namespace obliq
