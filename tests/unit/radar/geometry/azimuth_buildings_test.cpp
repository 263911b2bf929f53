// Buildings by azimuth bin: none is missing from a bin that its outline overlaps, whatever the kernels, and
// few are there that do not.
// The buildings of an azimuth bin by bearing: the same roofs as all buildings of the bin, from a few of them.
#include "server/radar/geometry/azimuth_buildings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

#include "server/radar/geometry/circle_axes.h"
#include "server/radar/geometry/silhouettes.h"
#include "server/radar/rays/plates/buildings_by_bearing.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/parallel.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::azimuth_buildings_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

BinGrid bins_of(const RadarSettings& settings) {
  BinGrid bins;
  bins.n_azimuth = settings.azimuth_bins;
  const double sector_rad = settings.sector_deg * std::numbers::pi / 180;
  bins.azimuth_start_rad = -sector_rad / 2;
  bins.azimuth_width_rad = sector_rad / settings.azimuth_bins;
  return bins;
}

/// Whether a silhouette reaches into a bin by more than its own rounding.
bool overlaps(const Silhouette& seen, const BinGrid& bins, int bin, double reach_m) {
  if (seen.near_m > reach_m) return false;
  const double from = bins.azimuth_edge_rad(bin), to = bins.azimuth_edge_rad(bin + 1);
  for (int turn = -1; turn <= 1; ++turn)
    if (seen.from_rad + turn * kTurn < to - 1e-12 && seen.to_rad + turn * kTurn > from + 1e-12) return true;
  return false;
}

/// Counts the entries that need not be there.
int expect_all_there(const Scene& scene, const RadarSettings& settings, const Pose& pose, double reach_m,
                     const std::string& text, bool by_corners) {
  const Sector sector(settings, pose);
  const BinGrid bins = bins_of(settings);
  const AzimuthBuildings buildings(scene, sector, bins, reach_m, by_corners);
  std::vector<Silhouette> exact;
  for (std::uint32_t b = 0; b < scene.world().buildings.list.size(); ++b)
    exact.push_back(silhouette_of(scene.world().buildings, sector, b));
  int spare = 0;
  for (int bin = 0; bin < bins.n_azimuth; ++bin) {
    const auto here = buildings.in(bin);
    EXPECT_TRUE(std::is_sorted(here.begin(), here.end(), std::less_equal<>())) << text;
    for (const Silhouette& seen : exact) {
      const bool there = std::binary_search(here.begin(), here.end(), seen.building);
      const bool needed = overlaps(seen, bins, bin, reach_m);
      EXPECT_TRUE(there || !needed) << text << ", building " << seen.building << ", bin " << bin;
      spare += there && !needed;
    }
  }
  return spare;
}

TEST(AzimuthBuildings, NoneIsMissingInRandomScenes) {
  int buildings = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    const RadarSettings settings = random.settings;
    const Pose pose = random.pose;
    const std::string text = random.text;
    const double reach_m = settings.r_max_m + 2 * random.world.grid.cell_m;
    const auto scene = test::scene_of(random);
    buildings += static_cast<int>(scene->world().buildings.list.size());
    for (const bool by_corners : {false, true})
      expect_all_there(*scene, settings, pose, reach_m, text, by_corners);
  }
  EXPECT_GT(buildings, 1200);
}

TEST(AzimuthBuildings, NoneIsMissingInNarrowBinsAndAllAround) {
  World world = test::made_world(40000, 500, [](double, double) { return 0.0; });
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-39000, 39000);
  for (int n = 0; n < 3000; ++n)
    test::add_prism(world, test::rectangle(place(random), place(random), 3 + n % 40, 4 + n % 7), 10);
  // Around the antenna, beside it, and across the direction in which bearings turn over.
  test::add_prism(world, test::rectangle(100, -200, 30, 30), 10);
  test::add_prism(world, test::rectangle(140, -200, 30, 30), 10);
  test::add_prism(world, test::rectangle(100, -9000, 4000, 10), 10);
  const Pose pose = test::pose_at(world, {100, 900, -200}, 0);
  const auto scene = test::make_scene(std::move(world));
  RadarSettings settings;
  settings.range_bins = 32;
  int spare = 0;
  for (const double sector_deg : {360.0, 359.9, 180.0, 60.0, 1.0, 0.01, 1e-4, 1e-9}) {
    settings.sector_deg = sector_deg;
    for (const int bins : {1, 7, 256}) {
      settings.azimuth_bins = bins;
      const int more = expect_all_there(*scene, settings, pose, 30000, std::to_string(sector_deg), false);
      if (bins == 256 && sector_deg == 60) spare = more;
    }
  }
  // A sixth of the buildings, half of which are in reach, in bins of four milliradians: circles are larger
  // than outlines, but not much.
  EXPECT_GT(spare, 0);
  EXPECT_LT(spare, 250);
}

TEST(AzimuthBuildings, AreTheSameForAllKernelsAndThreads) {
  World world = test::made_world(40000, 500, [](double, double) { return 0.0; });
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-39000, 39000);
  for (int n = 0; n < 60000; ++n)
    test::add_prism(world, test::rectangle(place(random), place(random), 3 + n % 40, 4 + n % 7), 10);
  const Pose pose = test::pose_at(world, {100, 900, -200}, 70);
  const auto scene = test::make_scene(std::move(world));
  RadarSettings settings;
  settings.sector_deg = 360;
  settings.azimuth_bins = 500;
  const Sector sector(settings, pose);
  const BinGrid bins = bins_of(settings);
  const AzimuthBuildings buildings(*scene, sector, bins, 30000);
  on_this_thread_alone([&] {
    const AzimuthBuildings alone(*scene, sector, bins, 30000);
    for (int bin = 0; bin < bins.n_azimuth; ++bin)
      ASSERT_TRUE(std::ranges::equal(buildings.in(bin), alone.in(bin))) << bin;
  });
  for (const AzimuthRange range : {AzimuthRange{0, 8}, AzimuthRange{490, 10}, AzimuthRange{3, 400}}) {
    std::vector<std::uint32_t> expected;
    for (int bin = range.first; bin < range.first + range.count; ++bin)
      expected.insert(expected.end(), buildings.in(bin).begin(), buildings.in(bin).end());
    std::ranges::sort(expected);
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    EXPECT_EQ(buildings.in(range), expected);
  }
  const CircleSector circles{circle_axes(scene->circles(), sector), 30000, -3, 3, 100, 600};
  const CircleExtent extent{circles.axes, true, 0.1f, -0.9f, 3000, 30000, 50, 4, -0.03f};
  const CircleRun run = circle_run(scene->circles(), 0, scene->circles().size());
  const auto n = static_cast<std::size_t>(run.n);
  std::vector<std::int32_t> first(n), last(n), other_first(n), other_last(n);
  std::vector<std::uint8_t> idle(n), other_idle(n);
  all_kernels()[0].circle_bins(circles, run, first.data(), last.data());
  all_kernels()[0].idle_circles(extent, run, idle.data());
  EXPECT_GT(std::ranges::count(idle, 1), 1000);
  EXPECT_GT(std::ranges::count(idle, 0), 1000);
  for (const Kernels& kernels : all_kernels()) {
    kernels.circle_bins(circles, run, other_first.data(), other_last.data());
    kernels.idle_circles(extent, run, other_idle.data());
    EXPECT_EQ(first, other_first) << kernels.name;
    EXPECT_EQ(last, other_last) << kernels.name;
    EXPECT_EQ(idle, other_idle) << kernels.name;
  }
}

TEST(BuildingCircles, HoldEveryCorner) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const test::RandomScene random = test::random_scene(seed);
    const Buildings& all = random.world.buildings;
    const BuildingCircles circles(all);
    for (std::uint32_t b = 0; b < all.list.size(); ++b) {
      const std::uint32_t ring = all.list[b].first_ring;
      for (std::uint32_t k = all.ring_start[ring]; k < all.ring_start[ring + 1]; ++k) {
        const glm::dvec2 corner(all.ring_xz_m[k]);
        const double distance = std::hypot(corner.x - static_cast<double>(circles.x_m[b]),
                                           corner.y - static_cast<double>(circles.z_m[b]));
        ASSERT_LE(distance, static_cast<double>(circles.radius_m[b])) << random.text;
        ASSERT_LE(std::abs(static_cast<double>(circles.x_m[b])), circles.reach_m * (1 + 1e-7));
      }
    }
  }
}

/// 40 x 40 houses around an antenna that stands over one of them.
std::shared_ptr<const Scene> houses_all_around() {
  World world = test::made_world(5000, 100, [](double, double) { return 0.0; });
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      test::add_prism(world,
                      test::rectangle((i - 20) * 200 + 7.0 * (j % 5), (j - 20) * 200 + 9.0 * (i % 7), 40, 30),
                      10 + i % 3);
  return test::make_scene(std::move(world));
}

std::shared_ptr<const ScenePlan> plan_of(const std::shared_ptr<const Scene>& scene, double sector_deg,
                                         int azimuth_bins, double bearing_deg) {
  RadarSettings s = test::radar_settings(FrustumKind::oblique, {100, 6000, sector_deg}, {azimuth_bins, 64},
                                         {azimuth_bins, 64});
  const ScenePlanResult planned =
      plan_scene(scene, s, test::pose_at(scene->world(), {3, 100, 5}, bearing_deg));
  if (!planned.plan) throw std::runtime_error(planned.errors.front().text());
  return planned.plan;
}

using Stretch = std::tuple<std::uint32_t, double, double, std::uint32_t>;

/// The stretches that reach into the distances from..to, sorted.
std::vector<Stretch> within(const std::vector<RoofSpan>& stretches, double from_m, double to_m) {
  std::vector<Stretch> found;
  for (const RoofSpan& s : stretches)
    if (s.far_m >= from_m && s.near_m <= to_m) found.emplace_back(s.building, s.near_m, s.far_m, s.wall);
  std::sort(found.begin(), found.end());
  return found;
}

TEST(BuildingsByBearing, FindsWhatAllBuildingsOfTheBinHave) {
  // Exactly: the same function on fewer buildings. Without the turns by 2 pi houses behind the antenna are
  // missing in the full circle; a house added once a turn would be there twice.
  const auto scene = houses_all_around();
  const struct {
    double sector_deg;
    int bins;
    double bearing_deg;
  } cases[] = {{360, 1, 0}, {360, 1, 77}, {360, 3, 200}, {60, 1, 30}, {60, 8, 170}, {300, 2, 45}};
  for (const auto& c : cases) {
    const auto plan = plan_of(scene, c.sector_deg, c.bins, c.bearing_deg);
    std::size_t stretches = 0;
    for (int bin = 0; bin < c.bins; ++bin) {
      const BuildingsByBearing fan(*plan, bin);
      const glm::dvec3& antenna = plan->sector().antenna_m;
      for (int k = 0; k <= 400; ++k) {  // the bin's edges are among them
        const double offset = plan->bins().azimuth_edge_rad(bin + k / 400.0);
        const glm::dvec3 to = plan->sector().world_from_antenna(std::sin(offset), 0, std::cos(offset));
        std::vector<RoofSpan> all;
        for (const std::uint32_t b : plan->buildings_in(bin))
          add_roof_spans(scene->world().buildings, b, antenna.x, antenna.z, to.x, to.z, all);
        for (const double from_m : {0.0, 700.0, 2500.0}) {
          std::vector<RoofSpan> found;
          fan.add_stretches(from_m, from_m + 1000, to.x, to.z, found);
          EXPECT_EQ(within(found, from_m, from_m + 1000), within(all, from_m, from_m + 1000))
              << c.sector_deg << " degrees, bin " << bin << " of " << c.bins << ", offset " << offset;
          stretches += found.size();
        }
      }
    }
    EXPECT_GT(stretches, 1000u);
  }
}

TEST(BuildingsByBearing, LooksAtFewBuildingsHoweverWideTheBin) {
  // 1600 houses in one bin. A plane passes houses of 50 m (diagonal) in rows 200 m apart: within reach of a
  // cell of 0.9 degrees (45 m at the middle distance) are some (50 + 45) / 200 of the 40 rows' houses in each
  // direction, 1 %, and those close by. Without cells (the named wrong version) it is all 1600.
  const auto scene = houses_all_around();
  const auto plan = plan_of(scene, 360, 1, 0);
  ASSERT_EQ(plan->buildings_in(0).size(), 1600u);
  const BuildingsByBearing fan(*plan, 0);
  for (int k = 0; k < 360; ++k) {
    const double bearing = k * kTurn / 360;
    EXPECT_LT(fan.candidates(std::sin(bearing), std::cos(bearing)), 80u) << k << " degrees";
  }
}

}  // namespace
}  // namespace obliq::azimuth_buildings_test
