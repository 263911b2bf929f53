// What towers over the antenna hides all ground behind them, however little slope a range bin has there.
#include <gtest/gtest.h>

#include <cmath>

#include "server/radar/render.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::long_shadow_test {
namespace {

/// Level ground to 20 km, and a house 100 m tall across all of the sector, 1,600 m away.
std::shared_ptr<const Scene> behind_a_house() {
  World world = test::made_world(21000, 100, [](double, double) { return 0.0; });
  test::add_prism(world, test::rectangle(0, 1620, 1200, 40), 100);
  return test::make_scene(std::move(world), test::two_materials());
}

constexpr int kBins = 400;

TEST(LongShadow, OfAHouseAboveTheAntennaIsDarkToItsEnd) {
  const auto scene = behind_a_house();
  for (const double spacing_m : {2.0, 10.0, 40.0}) {
    const double from_m = 20000 - kBins * spacing_m;
    const RadarSettings s =
        test::radar_settings(FrustumKind::sweep, {from_m, 20000, 30}, {16, kBins}, {32, 1});
    const Pose pose = test::pose_at(scene->world(), {0, 20, 0}, 0);
    const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
    double behind_w = 0;
    int shadow = 0, bins = 0;
    for (int a = 0; a < s.azimuth_bins; ++a)
      for (int r = 0; r < s.range_bins; ++r) {
        if (s.r_min_m + r * spacing_m < 1800) continue;
        const auto k = static_cast<std::size_t>(a * s.range_bins + r);
        ++bins;
        behind_w += frame.bins.power_w[k];
        shadow += frame.bins.state[k] == static_cast<std::uint8_t>(BinState::shadow) ? 1 : 0;
      }
    EXPECT_EQ(behind_w, 0) << "bins of " << spacing_m << " m";
    EXPECT_EQ(shadow, bins) << "bins of " << spacing_m << " m";
  }
}

}  // namespace
}  // namespace obliq::long_shadow_test
