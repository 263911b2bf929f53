// Buildings that a ray caster gets wrong: edge-on walls, solids inside solids, cliffs under houses, coplanar
// faces, needles, the smallest and the largest.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/radar/frame_plan.h"
#include "server/scene/exact_hit.h"
#include "tests/support/made_worlds.h"
#include "tests/support/rendered.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"
#include "tests/support/surface_check.h"

namespace obliq::buildings_test {
namespace {

using test::Rendered;
using test::rendered;

RadarSettings settings() {
  return test::radar_settings(FrustumKind::oblique, {600, 2800, 60}, {12, 40}, {180, 180});
}

/// Ground and buildings of one diffuse material, so that only geometry decides the power.
std::vector<Material> one_material() {
  Material same = test::two_materials()[0];
  same.gamma = 0.25;
  return {same, same};
}

World flat(double cell_m = 50) {
  return test::made_world(3000, cell_m, [](double, double) { return 0.0; });
}

TEST(HardBuildings, WallsSeenExactlyEdgeOnAddNothing) {
  // The antenna stands exactly in the plane of a long wall, of two walls at once, and a micrometre to either
  // side. From a micrometre aside the wall's projected area is 1e-6 / 1000 of what it is face on.
  World world = flat();
  test::add_prism(world, test::rectangle(100, 1300, 200, 1000), 30);  // west wall at x = 0
  test::add_prism(world, test::rectangle(-300, 1500, 200, 400), 30);  // faces elsewhere
  const auto scene = test::make_scene(std::move(world), one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const auto at = [&](double x) {
      return rendered(scene, s, test::pose_at(scene->world(), {x, 500, 0}, 0), sampling);
    };
    const Rendered exact = at(0);
    EXPECT_GT(exact.totals.power_w, 0);
    // Columns next to the wall's plane may fall on either side of it: one in 180, and of those the roof's
    // edge alone (30 m of 500 m of height).
    for (const double x : {-1e-6, 1e-6, -1e-9, 1e-9})
      EXPECT_NEAR(at(x).totals.power_w / exact.totals.power_w, 1, 1e-3) << x;
  }
}

TEST(HardBuildings, OneInsideAnotherChangesNothing) {
  // Nested with a lower roof: nothing of it can be seen. To the bit, but for the order of ties that there are
  // none of.
  World outer = flat();
  test::add_prism(outer, test::rectangle(50, 1300, 300, 200), 40);
  World nested = outer;
  test::add_prism(nested, test::rectangle(60, 1310, 100, 80), 25);
  test::add_prism(nested, test::rectangle(60, 1310, 10, 8), 39.5);
  const auto one = test::make_scene(std::move(outer)), three = test::make_scene(std::move(nested));
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const Pose pose = test::pose_at(one->world(), {-20, 550, 3}, 4);
    const Rendered a = rendered(one, s, pose, sampling), b = rendered(three, s, pose, sampling);
    if (!sampling.one_sample_a_ray()) {
      // Stretches of surface are cut where buildings are, seen or not: other midpoints of the same surface.
      EXPECT_NEAR(b.totals.power_w / a.totals.power_w, 1, 1e-4);
      continue;
    }
    EXPECT_EQ(a.frame.bins.power_w, b.frame.bins.power_w);
    EXPECT_EQ(a.frame.bins.iq, b.frame.bins.iq);
    EXPECT_EQ(a.frame.bins.state, b.frame.bins.state);
  }
}

TEST(HardBuildings, OverlappingOnesAreTheirUnion) {
  // Two slabs of one height that cross, and the same outline as one building: roofs coplanar where they
  // overlap, walls inside solids. A point counted twice would double its power.
  World crossed = flat(), whole = flat();
  test::add_prism(crossed, {{-100, 1200}, {100, 1200}, {100, 1500}, {-100, 1500}}, 40);
  test::add_prism(crossed, {{-300, 1300}, {300, 1300}, {300, 1400}, {-300, 1400}}, 40);
  test::add_prism(whole,
                  {{-100, 1200},
                   {100, 1200},
                   {100, 1300},
                   {300, 1300},
                   {300, 1400},
                   {100, 1400},
                   {100, 1500},
                   {-100, 1500},
                   {-100, 1400},
                   {-300, 1400},
                   {-300, 1300},
                   {-100, 1300}},
                  40);
  const auto two = test::make_scene(std::move(crossed), one_material());
  const auto one = test::make_scene(std::move(whole), one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const Pose pose = test::pose_at(one->world(), {-20.5, 550, 3.25}, 4);
    const Rendered a = rendered(two, s, pose, sampling), b = rendered(one, s, pose, sampling);
    if (!sampling.one_sample_a_ray()) {
      EXPECT_NEAR(b.totals.power_w / a.totals.power_w, 1, 2e-4);  // stretches cut elsewhere
      continue;
    }
    // The same surface met by the same rays: rounding of a few planes' equations.
    EXPECT_EQ(a.frame.bins.state, b.frame.bins.state);
    for (std::size_t k = 0; k < a.frame.bins.power_w.size(); ++k)
      EXPECT_NEAR(a.frame.bins.power_w[k], b.frame.bins.power_w[k], 1e-9 * b.frame.bins.power_w[k]) << k;
  }
}

TEST(HardBuildings, AcrossACliffTheyStandWhereTheGroundIsLower) {
  // 200 m of cliff within one cell at z = 1300; the roof lies at the corners' mean, so that the upper half is
  // buried in the cliff's top.
  for (const bool looking_up : {true, false}) {
    World world = test::made_world(
        3000, 50, [&](double, double z) { return (looking_up ? z > 1300 : z < 1300) ? 200.0 : 0.0; });
    test::add_prism(world, test::rectangle(40, 1325, 260, 150), 12);
    test::add_prism(world, test::rectangle(-320, 1325, 160, 40), 130);
    const auto scene = test::make_scene(std::move(world), one_material());
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(sampling.name);
      RadarSettings s = test::sampled(settings(), sampling);
      s.r_min_m = 650;
      const Rendered frame =
          rendered(scene, s, test::pose_at(scene->world(), {-20.5, 640, 3.25}, 4), sampling);
      EXPECT_GT(frame.totals.power_w, 0);
    }
  }
}

TEST(HardBuildings, RoofsCoplanarWithTheGroundAreOneSurface) {
  // A terrace at 50 m, and a house against it whose roof is exactly as high: 25 m over corners whose mean is
  // 25 m. Half of the roof lies in the terrace's plane. Either may be hit; the power is that of a roof a
  // millimetre lower or higher, which moves ranges by a millimetre in 1,300 m and their power by 3e-6 each,
  // but for samples that change bins: a millimetre in 55 m, 2e-5 of them.
  const auto scene_with = [](double above_m) {
    World world = test::made_world(3000, 50, [](double, double z) { return z >= 1300 ? 50.0 : 0.0; });
    test::add_prism(world, test::rectangle(40, 1275, 200, 150), 25 + above_m);
    return test::make_scene(std::move(world), one_material());
  };
  const auto exact = scene_with(0), lower = scene_with(-1e-3), higher = scene_with(1e-3);
  ASSERT_EQ(exact->world().buildings.list[0].roof_y_m, 50.0f);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const Pose pose = test::pose_at(exact->world(), {-20.5, 590, 3.25}, 4);
    const Rendered a = rendered(exact, s, pose, sampling, {.threads = 1});
    const Rendered again = rendered(exact, s, pose, sampling, {.threads = 3});
    EXPECT_EQ(a.frame.bins.iq, again.frame.bins.iq) << "whichever is hit, every time the same";
    EXPECT_NEAR(rendered(lower, s, pose, sampling).totals.power_w / a.totals.power_w, 1, 1e-3);
    EXPECT_NEAR(rendered(higher, s, pose, sampling).totals.power_w / a.totals.power_w, 1, 1e-3);
  }
}

TEST(HardBuildings, NeedlesAreFiniteAndHideNextToNothing) {
  World bare = flat();
  test::add_prism(bare, test::rectangle(-400, 1800, 20, 20), 5);  // the same top of the scene: the same rays
  World world = bare;
  // A wall 2 cm thick and 800 m long along the line of sight, one across it, a triangle of a thousandth of a
  // radian, a sliver whose corners lie within 2^-10 m of a line.
  test::add_prism(world, test::rectangle(-100, 1500, 0.02, 800), 3);
  test::add_prism(world, test::rectangle(200, 1400, 800, 0.02), 3);
  test::add_prism(world, {{0, 1000}, {0.5, 1500}, {0, 1500}}, 3);
  test::add_prism(world, {{50, 1000}, {300, 1100.0078125}, {550, 1200}, {300, 1099.5}}, 3);
  const auto without = test::make_scene(std::move(bare), one_material());
  const auto with = test::make_scene(std::move(world), one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const Pose pose = test::pose_at(with->world(), {-20.5, 550, 3.25}, 4);
    const Rendered a = rendered(without, s, pose, sampling), b = rendered(with, s, pose, sampling);
    // One material: what a needle hides it scatters itself, from at most 8 m nearer (3 m of height under 21
    // degrees), 1 % of power, on those pixels that would have met the 8 m behind it: 5e-4 of the energy for
    // the long one across, less for the others.
    EXPECT_NEAR(b.totals.power_w / a.totals.power_w, 1, 2e-5);
  }
}

TEST(HardBuildings, OneCentimetreAndOneKilometre) {
  World world = flat();
  test::add_prism(world, test::rectangle(-200, 1000, 1.0, 0.01), 0.01);  // a kerb
  test::add_prism(world, test::rectangle(-100, 1000, 500, 500), 0.01);   // paving
  test::add_prism(world, test::rectangle(700, 2000, 1000, 1000), 1000);  // a block above the antenna
  OutlineShaper shaper;
  EXPECT_EQ(shaper.shape(Polygon{{test::rectangle(0, 0, 0.01, 0.01)}}).state, OutlineState::zero_area);
  const auto scene = test::make_scene(std::move(world), one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const Pose pose = test::pose_at(scene->world(), {-20.5, 550, 3.25}, 4);
    const Rendered frame = rendered(scene, s, pose, sampling);
    if (frame.refused) continue;
    EXPECT_GT(frame.totals.power_w, 0);
    // Behind the block, beyond 2,600 m at 17 degrees east of north, nothing is seen.
    const auto azimuth = static_cast<std::size_t>((17.0 - 4 + 30) / 5);
    for (std::size_t r = 37; r < 40; ++r)
      EXPECT_NE(frame.frame.bins.state[azimuth * 40 + r], 1) << "range bin " << r;
  }
}

TEST(HardBuildings, WithoutACornerInTheSectorOrInRangeAreLookedAtAllTheSame) {
  // A block wider than a sector of one degree, and one so high that its roof is out of range while its wall
  // is not. A sector bounded by roof corners alone casts no ray at either.
  World wide = flat(), high = flat();
  test::add_prism(wide, test::rectangle(0, 1700, 1600, 800), 300);
  test::add_prism(high, test::rectangle(0, 1700, 400, 400), 4000);
  const auto roof = test::make_scene(std::move(wide), one_material());
  const auto wall = test::make_scene(std::move(high), one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    s.sector_deg = 1;
    s.azimuth_bins = 2;
    s.pixel_columns = 24;
    s.pixel_rows = 1000;
    const PlanResult planned =
        plan_frame(roof, test::snapshot(s), test::pose_at(roof->world(), {1.5, 550, 3.25}, 0));
    ASSERT_TRUE(planned.plan);
    EXPECT_EQ(planned.plan->looks_at().extent().top_y_m, 300);
    rendered(roof, s, planned.plan->pose(), sampling);
    const Rendered seen = rendered(wall, s, test::pose_at(wall->world(), {1.5, 550, 3.25}, 0), sampling);
    if (seen.refused) continue;
    // The wall, 1,497 m away, fills every bin from there to r_max.
    for (std::size_t r = 18; r < 40; ++r) EXPECT_EQ(seen.frame.bins.state[r], 1) << "range bin " << r;
  }
}

TEST(HardBuildings, AnAntennaOverARoofsEdgeOnItsCornerOrAgainstAWallSeesFiniteThings) {
  World world = flat();
  test::add_prism(world, test::rectangle(0, 0, 100, 100), 20);
  const auto scene = test::make_scene(std::move(world), one_material());
  // Over an edge, over a corner, over the centre, a micrometre off a wall, exactly on a wall, on its corner,
  // on the roof's edge, on the roof itself.
  for (const glm::dvec3& antenna :
       {glm::dvec3(50, 100, 10), glm::dvec3(50, 100, 50), glm::dvec3(0, 20.001, 0),
        glm::dvec3(50 + 1e-6, 10, 7), glm::dvec3(50, 10, 7), glm::dvec3(50, 10, 50), glm::dvec3(50, 20, 50),
        glm::dvec3(0, 20, 0)}) {
    for (const test::Sampling& sampling : test::kSamplings) {
      for (const double bearing_deg : {0.0, 90.0, 270.0}) {
        SCOPED_TRACE(std::string(sampling.name) + " at " + std::to_string(antenna.x) + ", " +
                     std::to_string(antenna.y) + ", " + std::to_string(antenna.z) + " looking " +
                     std::to_string(bearing_deg));
        RadarSettings s = test::sampled(settings(), sampling);
        s.r_min_m = sampling.rays() ? 110 : 0;
        s.sector_deg = sampling.frustum == FrustumKind::symmetric ? 60 : 360;
        const Pose pose = test::pose_at(scene->world(), antenna, bearing_deg);
        const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
        if (!planned.plan) {
          EXPECT_TRUE(sampling.rays()) << planned.errors.front().text();
          continue;
        }
        const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
        test::expect_sane(frame, s, scene->materials());
      }
    }
  }
}

}  // namespace
}  // namespace obliq::buildings_test
