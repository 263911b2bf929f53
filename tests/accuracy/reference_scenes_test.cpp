// What holds for the reference renderer on any scene: voids, antennas outside the grid and below peaks, 360
// degree sectors, nested and tiny buildings.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/accuracy/reference_support.h"
#include "tests/support/random_scenes.h"

namespace obliq {
namespace {

/// Constant gamma of 1 everywhere, so that a bin's power is K times the integral of its solid angle over r^2.
const std::vector<Material> kDiffuse(256, Material{});

ReferenceView view_of(const test::RandomScene& scene) {
  const RadarSettings& s = scene.settings;
  return test::view_from(scene.pose.antenna.m, scene.pose.bearing_world_rad / kDegree_rad, s.sector_deg,
                         s.azimuth_bins, s.r_min_m, s.r_max_m, s.range_bins);
}

TEST(ReferenceScenes, PowersAreFiniteAndNoMoreThanTheWholeSphereReturns) {
  // All directions of a sector are 2 S steradians; power times r^2, r at least the bin's near edge, is K
  // gamma times the solid angle. A version that integrates what is hidden as well, or a wall edge-on by its
  // own area, goes beyond.
  int lit = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const ReferenceView view = view_of(scene);
    const ReferenceBins bins = test::integrate_all(scene.world, kDiffuse, view, {4, 2, 0});
    double weighted = 0;
    for (int a = 0; a < bins.n_azimuth; ++a) {
      for (int r = 0; r < bins.n_range; ++r) {
        const std::size_t k = test::bin_index(bins, a, r);
        ASSERT_TRUE(bins.ground_w[k] >= 0 && std::isfinite(bins.ground_w[k])) << scene.text;
        ASSERT_TRUE(bins.building_w[k] >= 0 && std::isfinite(bins.building_w[k])) << scene.text;
        weighted += (bins.ground_w[k] + bins.building_w[k]) * std::pow(test::range_edge_m(view, r), 2);
      }
    }
    EXPECT_LE(weighted, test::range_constant(view) * 2 * view.sector_rad * 1.001) << scene.text;
    if (weighted > 0) ++lit;
  }
  std::printf("    %d of 400 scenes with light\n", lit);
  EXPECT_GT(lit, 200);
}

TEST(ReferenceScenes, ABuildingIsNeverSeenBetterThanAlone) {
  // What is lit among others is a part of what is lit alone, cut at other places: the quadratures differ by
  // their error, a thousandth at 2 m (step_m r / 200 m is a hundredth of the range).
  int partly = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const ReferenceBins bins = test::integrate_all(scene.world, kDiffuse, view_of(scene), {4, 2, 0});
    ASSERT_EQ(bins.buildings.size(), scene.world.buildings.list.size());
    for (const BuildingTruth& building : bins.buildings) {
      EXPECT_LE(building.visible_sr, building.unoccluded_sr * 1.001) << scene.text;
      EXPECT_GE(building.visible_sr, 0) << scene.text;
      EXPECT_EQ(building.largest_share > 0, building.visible_sr > 0) << scene.text;
      EXPECT_LE(building.largest_share, 1 + 1e-12) << scene.text;
      if (building.visible_sr > 0 && building.visible_sr < 0.9 * building.unoccluded_sr) ++partly;
    }
  }
  std::printf("    %d buildings partly hidden by others or by ground\n", partly);
  EXPECT_GT(partly, 20);
}

TEST(ReferenceScenes, BitsDoNotDependOnThreadsOrOnWhichAzimuthsAreAskedFor) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const ReferenceView view = view_of(scene);
    const ReferenceBins one = test::integrate_all(scene.world, kDiffuse, view, {4, 2, 1});
    const ReferenceBins three = test::integrate_all(scene.world, kDiffuse, view, {4, 2, 3});
    EXPECT_EQ(one.ground_w, three.ground_w) << scene.text;
    EXPECT_EQ(one.building_w, three.building_w) << scene.text;
    for (std::size_t b = 0; b < one.buildings.size(); ++b) {
      EXPECT_EQ(one.buildings[b].visible_sr, three.buildings[b].visible_sr) << scene.text;
      EXPECT_EQ(one.buildings[b].unoccluded_sr, three.buildings[b].unoccluded_sr) << scene.text;
    }
    const int last = view.azimuth_bins - 1;
    const ReferenceBins part = integrate_reference(scene.world, kDiffuse, view, {4, 2, 1}, last, 1);
    for (int r = 0; r < view.range_bins; ++r)
      EXPECT_EQ(part.ground_w[static_cast<std::size_t>(r)], one.ground_w[test::bin_index(one, last, r)])
          << scene.text;
  }
}

}  // namespace
}  // namespace obliq
