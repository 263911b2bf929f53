// No building that the truth sees is missed by exact planes of the sweep, at any range: houses far narrower
// than a column, behind each other and behind hills, and random scenes.
#include <gtest/gtest.h>

#include <cstdio>

#include "server/accuracy/bin_errors.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

struct Tally {
  int seen = 0, missed = 0;
};

void look(World world, const Pose& pose, RadarSettings s, int truth_planes, Tally& tally,
          const std::string& text) {
  s.frustum = FrustumKind::sweep;
  s.sub_columns = 0;
  ReferenceView view = test::view_from(pose.antenna.m, pose.bearing_world_rad / kDegree_rad, s.sector_deg,
                                       s.azimuth_bins, s.r_min_m, s.r_max_m, s.range_bins);
  view.wavelength_m = 299792458.0 / (s.frequency_ghz * 1e9);
  std::vector<Material> materials(8, test::two_materials()[1]);
  materials[0] = test::two_materials()[0];
  const ReferenceBins truth = test::integrate_all(world, materials, view, {truth_planes, 2, 0});
  const auto scene = test::make_scene(std::move(world), materials);
  const auto plan = plan_frame(scene, test::snapshot(s), pose).plan;
  ASSERT_TRUE(plan);
  RenderOptions options;
  options.states = false;
  render_wedges(*plan, {0, s.azimuth_bins}, options);
  for (std::uint32_t b = 0; b < truth.buildings.size(); ++b) {
    const BuildingTruth& t = truth.buildings[b];
    if (!truth_sees_building(t.visible_sr, t.unoccluded_sr, t.largest_share)) continue;
    ++tally.seen;
    if (plan->looks_at().seen().has(b)) continue;
    ++tally.missed;
    std::printf("    missed building %u: %.2f %% of it seen, %.2f %% of a bin; %s\n", b,
                100 * t.visible_sr / t.unoccluded_sr, 100 * t.largest_share, text.c_str());
  }
}

TEST(SweepBuildings, OfATownOnHillsAreNeverMissedAtAnyRange) {
  // 10 m houses out to 30 km, where an azimuth bin is 500 m wide: 50 houses abreast in one column. Rays or
  // planes at the columns' centres alone (the named wrong version) would miss 19 in 20.
  World world = test::made_world(31000, 250, test::hills_m);
  for (int n = 0; n < 1000; ++n) {
    const double range = 3000 + 26.5 * n, bearing = 0.9 * (n * 0.618 - std::floor(n * 0.618) - 0.5);
    const double x = range * std::sin(bearing), z = range * std::cos(bearing);
    const double turn = 0.9 * n, a = 4 + n % 3, b = 5 + n % 4;
    const glm::dvec2 u(a * std::cos(turn), a * std::sin(turn)), v(-b * std::sin(turn), b * std::cos(turn));
    const glm::dvec2 at(x, z);
    test::add_prism(world, {at - u - v, at + u - v, at + u + v, at - u + v}, 6 + n % 5 * 2);
  }
  RadarSettings s;
  s.sector_deg = 40;
  s.r_min_m = 2500;
  s.r_max_m = 30000;
  s.azimuth_bins = 40;
  s.range_bins = 256;
  s.pixel_columns = 1;  // one plane a bin, the fewest there are
  const Pose pose = test::pose_at(world, {0, 1200, 0}, 0);
  Tally tally;
  look(std::move(world), pose, s, 600, tally, "town");
  std::printf("    %d buildings seen by the truth, %d missed\n", tally.seen, tally.missed);
  EXPECT_GT(tally.seen, 200);
  EXPECT_EQ(tally.missed, 0);
}

TEST(SweepBuildings, OfRandomScenesAreNeverMissed) {
  Tally tally;
  for (std::uint64_t seed = 80000; seed < 80800; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    if (random.world.buildings.list.empty()) continue;
    look(std::move(random.world), random.pose, random.settings, 64, tally, random.text);
  }
  std::printf("    %d buildings seen by the truth, %d missed\n", tally.seen, tally.missed);
  EXPECT_GT(tally.seen, 250);
  EXPECT_EQ(tally.missed, 0);
}

}  // namespace
}  // namespace obliq
