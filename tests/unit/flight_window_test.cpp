#include <gtest/gtest.h>

#include "server/control/aim_world.h"
#include "server/flight/window.h"

namespace obliq::test {
namespace {

// On the equator a degree of longitude of the mean sphere is 111.195 km.
constexpr double kDegree_km = 111.195;

SceneConfig equator_config(double r_max_m) {
  SceneConfig config;
  config.radars.emplace_back();
  config.radars[0].settings.r_max_m = r_max_m;
  aim_world(config);
  return config;
}

RadarPlace east(double km, double r_max_m) { return {{km / kDegree_km, 0}, r_max_m}; }

TEST(FlightWindow, DistanceIsTheGreatCirclesEvenAcrossTheAntimeridian) {
  EXPECT_NEAR(distance_m({0, 0}, {1, 0}), 111195, 1);
  EXPECT_NEAR(distance_m({179.5, 0}, {-179.5, 0}), 111195, 1);
  EXPECT_NEAR(distance_m({10, 0}, {10, 90}), 10007557, 10) << "a quarter of the way round";
  EXPECT_NEAR(distance_m({10, 60}, {11, 60}), 55595, 10) << "cos 60 degrees, and the great circle is shorter";
}

TEST(FlightWindow, IsDueWhenHalfOfTheMarginIsUsed) {
  const SceneConfig config = equator_config(40000);  // margin 10 km
  const SceneWindow window = window_of(config);
  const auto due = [&](double km) {
    const RadarPlace place = east(km, 40000);
    return needs_next_window(config, window, std::span(&place, 1), 0, 0);
  };
  EXPECT_FALSE(due(0));
  EXPECT_FALSE(due(4.99));
  EXPECT_TRUE(due(5.01));
  EXPECT_TRUE(due(-5.01));
}

TEST(FlightWindow, IsDueEarlierForAFastRadarButNeverAtOnceAgain) {
  const SceneConfig config = equator_config(40000);
  const RadarPlace moved = east(3, 40000);
  EXPECT_FALSE(needs_next_window(config, window_of(config), std::span(&moved, 1), 83, 10));
  // 7 km of the margin are left: 700 m/s for 11 s eat more.
  EXPECT_TRUE(needs_next_window(config, window_of(config), std::span(&moved, 1), 700, 11));
  const RadarPlace still = east(0, 40000);
  EXPECT_FALSE(needs_next_window(config, window_of(config), std::span(&still, 1), 1e6, 100));
}

TEST(FlightWindow, LeavesNothingToDoOnceItIsBuilt) {
  const SceneConfig config = equator_config(40000);
  for (const double km : {5.5, 16.0, 25.0, 400.0, 20000.0}) {
    const RadarPlace place = east(km, 40000);
    const SceneWindow next = next_window(config, window_of(config), std::span(&place, 1));
    EXPECT_FALSE(needs_next_window(config, next, std::span(&place, 1), 300, 10)) << km;
  }
}

TEST(FlightWindow, TheOriginStaysUntilThreeQuartersOfTheWayAndThenIsTheFirstRadars) {
  const SceneConfig config = equator_config(40000);
  const RadarPlace near[] = {east(14.9, 40000), east(30, 40000)};
  EXPECT_EQ(next_window(config, window_of(config), near).origin.longitude_deg, 0);
  const RadarPlace far[] = {east(15.1, 40000), east(30, 40000)};
  EXPECT_EQ(next_window(config, window_of(config), far).origin.longitude_deg, far[0].position.longitude_deg);
}

TEST(FlightWindow, WithAnAreaOnlyTheOriginMoves) {
  SceneConfig config = equator_config(40000);
  config.world.terrain.area = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const RadarPlace near = east(19.9, 40000);
  EXPECT_FALSE(needs_next_window(config, window_of(config), std::span(&near, 1), 300, 10));
  const RadarPlace far = east(20.1, 40000);
  EXPECT_TRUE(needs_next_window(config, window_of(config), std::span(&far, 1), 300, 10));
}

TEST(FlightWindow, SwitchedOffIsNeverDue) {
  SceneConfig config = equator_config(40000);
  config.flight.enabled = false;
  const RadarPlace far = east(500, 40000);
  EXPECT_FALSE(needs_next_window(config, window_of(config), std::span(&far, 1), 300, 10));
}

TEST(FlightWindow, ARangeBeyondTheSceneFilesIsNotFollowedUnlessAllowed) {
  SceneConfig config = equator_config(40000);
  const RadarPlace longer = east(0, 200000);
  EXPECT_FALSE(needs_next_window(config, window_of(config), std::span(&longer, 1), 0, 0));
  config.flight.max_reach_km = 100;
  EXPECT_TRUE(needs_next_window(config, window_of(config), std::span(&longer, 1), 0, 0));
  EXPECT_EQ(next_window(config, window_of(config), std::span(&longer, 1)).reaches[0].radius_m, 125000);
}

TEST(FlightWindow, PostsAreThoseOfTheRectangleAroundAllReaches) {
  SceneWindow window;
  window.reaches = {{{0, 0}, 10000}, {{1, 0}, 10000}};
  EXPECT_NEAR(window_posts(window, 100), 1311.95 * 200, 10) << "131.195 km x 20 km";
}

}  // namespace
}  // namespace obliq::test
