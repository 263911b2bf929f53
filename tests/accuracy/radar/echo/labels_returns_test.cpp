// The label `returns`: a wall before ground in closed form, and the sweep's planes against exact ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "tests/accuracy/radar/echo/labels_support.h"
#include "tests/support/made_worlds.h"

namespace obliq::test::labels_returns_test {
namespace {

/// A long wall across the sight, its roof deep, on level ground.
class WallBeforeGround : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(EveryWay, WallBeforeGround, testing::ValuesIn(kWays),
                         [](const auto& way) { return std::string(way.param.name); });

TEST_P(WallBeforeGround, IsLayover) {
  constexpr double kAntenna_m = 1000, kNear_m = 3000, kFar_m = 3600, kWall_m = 100;
  World world = made_world(8000, 50, [](double, double) { return 0.0; });
  add_prism(world, rectangle(0, (kNear_m + kFar_m) / 2, 6000, kFar_m - kNear_m), kWall_m);
  const auto scene = make_scene(world, two_materials(), RayMethod::march);
  const Pose pose = pose_at(world, {0, kAntenna_m, 0}, 0);
  RadarSettings s = GetParam().settings();
  s.sector_deg = s.azimuth_bins * 0.02;  // half a degree about north: ranges are those of north to 0.03 m
  if (GetParam().beam) s.beam.width_deg = 0.1;
  s.r_min_m = 2800;
  s.r_max_m = 4400;
  RenderOptions options;
  options.labels = true;
  const Frame frame = render(scene, snapshot(s), pose, {0, s.azimuth_bins}, options);
  const double over_roof_m = kAntenna_m - kWall_m;
  const double top_m = std::hypot(kNear_m, over_roof_m);
  const double foot_m = std::hypot(kNear_m, kAntenna_m);
  const double back_m = std::hypot(kFar_m, over_roof_m);
  const double shadow_m = std::hypot(kFar_m * kAntenna_m / over_roof_m, kAntenna_m);
  const auto strictly_in = [](double near, double far, double a, double b) {
    return near > a + 0.5 && far < b - 0.5;
  };
  int two = 0, three = 0, dark = 0;
  for (int a = 8; a < 40; ++a) {
    for (int r = 0; r < s.range_bins; ++r) {
      const double near = s.r_min_m + r * s.range_bin_m(), far = near + s.range_bin_m();
      const int found = frame.bins.labels.returns[static_cast<std::size_t>(a * s.range_bins + r)];
      if (far < top_m - 0.5 || near > shadow_m + 0.5) {
        ASSERT_EQ(found, 1) << "ground at " << near;
      } else if (strictly_in(near, far, top_m, foot_m)) {
        ASSERT_EQ(found, 3) << "ground, wall and roof at " << near;
        ++three;
      } else if (near < top_m && far > top_m) {
        ASSERT_EQ(found, 2) << "ground, and the edge of the roof at " << near;
        ++two;
      } else if (strictly_in(near, far, foot_m, back_m)) {
        ASSERT_EQ(found, 1) << "roof at " << near;
      } else if (strictly_in(near, far, back_m, shadow_m)) {
        ASSERT_EQ(found, 0) << "shadow at " << near;
        ++dark;
      }
    }
  }
  EXPECT_GT(two, 30);
  EXPECT_GT(three, 30);
  EXPECT_GT(dark, 100);
}

/// Bins whose returns differ between the sweep and exact planes, and those with layover.
struct Compared {
  int differ = 0, layover = 0, bins = 0;
};
Compared compare_returns(const std::shared_ptr<const Scene>& scene, int range_bins) {
  RadarSettings s = Way{"sweep"}.settings();
  s.range_bins = range_bins;
  const Frame swept = labelled(scene, s);
  s.sub_columns = 0;  // whose two planes a bin stand where the sweep's do
  const Frame exact = labelled(scene, s);
  Compared found;
  found.bins = static_cast<int>(swept.bins.state.size());
  for (std::size_t bin = 0; bin < swept.bins.state.size(); ++bin) {
    found.differ += swept.bins.labels.returns[bin] != exact.bins.labels.returns[bin] ? 1 : 0;
    found.layover += exact.bins.labels.returns[bin] > 1 ? 1 : 0;
  }
  std::printf("    %d of %d bins differ, %d have layover\n", found.differ, found.bins, found.layover);
  return found;
}

TEST(Labels, ReturnsOfSweptGroundAreThoseOfExactPlanes) {
  WorldSpec spec = synthetic_spec(SyntheticKind::hills, 7000, 30);
  spec.terrain.shape.height_m = 600;
  const Compared found = compare_returns(make_scene(load_world(spec)), 160);
  EXPECT_GT(found.layover, 100);
  EXPECT_LE(found.differ, 16)
      << "a bin edge within the rounding of floats, millimetres, of a crest: 2 per mille";
}

TEST(Labels, ReturnsOfASweptTownAreThoseOfExactPlanes) {
  const Compared found = compare_returns(striped_town(), 960);
  EXPECT_GT(found.layover, 300);
  EXPECT_LE(found.differ, found.bins / 100)
      << "roofs under the slope of a hill, and ground that all sub-columns hide: one in a hundred";
}

}  // namespace
}  // namespace obliq::test::labels_returns_test
