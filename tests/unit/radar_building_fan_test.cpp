// The buildings of an azimuth bin by bearing: the same roofs as all buildings of the bin, from a few of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "server/radar/rays/plates/buildings_by_bearing.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

constexpr double kTurn_rad = 2 * std::numbers::pi;

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
  RadarSettings s;
  s.frustum = FrustumKind::oblique;
  s.sector_deg = sector_deg;
  s.r_min_m = 100;
  s.r_max_m = 6000;
  s.azimuth_bins = azimuth_bins;
  s.range_bins = 64;
  s.pixel_columns = azimuth_bins;
  s.pixel_rows = 64;
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
    const double bearing = k * kTurn_rad / 360;
    EXPECT_LT(fan.candidates(std::sin(bearing), std::cos(bearing)), 80u) << k << " degrees";
  }
}

}  // namespace
}  // namespace obliq
