#include <gtest/gtest.h>

#include "server/control/scene_file.h"
#include "server/flight/window.h"

namespace obliq::test {
namespace {

// On the equator a degree of longitude of the mean sphere is 111.195 km.
constexpr double kDegree_km = 111.195;

SceneConfig equator_config(double r_max_m) {
  SceneConfig config;
  config.radars.emplace_back();
  config.radars[0].settings.r_max_m = r_max_m;
  set_terrain_reach(config);
  return config;
}

RadarPlace east(double km, double r_max_m) { return {{km / kDegree_km, 0}, r_max_m}; }

TEST(FlightWindow, DistanceIsTheGreatCirclesEvenAcrossTheAntimeridian) {
  EXPECT_NEAR(distance_m({0, 0}, {1, 0}), 111195, 1);
  EXPECT_NEAR(distance_m({179.5, 0}, {-179.5, 0}), 111195, 1);
  EXPECT_NEAR(distance_m({10, 0}, {10, 90}), 10007557, 10) << "a quarter of the way round";
  EXPECT_NEAR(distance_m({10, 60}, {11, 60}), 55595, 10) << "cos 60 degrees, and the great circle is shorter";
}

bool due(const SceneConfig& config, const SceneWindow& window, const RadarPlace& here,
         const RadarPlace& ahead) {
  return needs_next_window(config, window, std::span(&here, 1), std::span(&ahead, 1));
}
bool due(const SceneConfig& config, const RadarPlace& here) {
  return due(config, window_of(config), here, here);
}
SceneWindow next(const SceneConfig& config, const RadarPlace& here, const RadarPlace& ahead) {
  return next_window(config, window_of(config), std::span(&here, 1), std::span(&ahead, 1));
}

TEST(FlightWindow, IsDueWhenHalfOfTheMarginIsUsed) {
  const SceneConfig config = equator_config(40000);  // margin 10 km
  EXPECT_FALSE(due(config, east(0, 40000)));
  EXPECT_FALSE(due(config, east(4.99, 40000)));
  EXPECT_TRUE(due(config, east(5.01, 40000)));
  EXPECT_TRUE(due(config, east(-5.01, 40000)));
}

TEST(FlightWindow, IsDueEarlierForAFastRadar) {
  const SceneConfig config = equator_config(40000);
  EXPECT_FALSE(due(config, window_of(config), east(3, 40000), east(4.5, 40000)));
  EXPECT_TRUE(due(config, window_of(config), east(3, 40000), east(6, 40000)));
  EXPECT_FALSE(due(config, window_of(config), east(-8, 40000), east(-2, 40000))) << "it comes back";
}

TEST(FlightWindow, LeavesNothingToDoOnceItIsBuilt) {
  const SceneConfig config = equator_config(40000);
  for (const double km : {5.5, 16.0, 25.0, 400.0, 20000.0}) {
    const RadarPlace here = east(km, 40000);
    EXPECT_FALSE(due(config, next(config, here, here), here, here)) << km;
    for (const double ahead_km : {4.0, 5.0, 500.0, -500.0}) {  // 100 km/s: a jump
      const RadarPlace ahead = east(km + ahead_km, 40000);
      const SceneWindow built = next(config, here, ahead);
      EXPECT_FALSE(due(config, built, here, ahead)) << km << ", ahead by " << ahead_km;
      EXPECT_FALSE(due(config, built, here, here)) << km << ", stopped, ahead by " << ahead_km;
    }
  }
}

TEST(FlightWindow, LiesAheadButNotSoFarThatTheRadarIsNotInIt) {
  const SceneConfig config = equator_config(40000);
  const RadarPlace here = east(10, 40000);
  EXPECT_NEAR(next(config, here, east(12, 40000)).reaches[0].centre.longitude_deg, 12 / kDegree_km, 1e-9);
  EXPECT_NEAR(next(config, here, east(90, 40000)).reaches[0].centre.longitude_deg, 14.5 / kDegree_km, 1e-4)
      << "45 % of the margin";
}

TEST(FlightWindow, TheOriginStaysUntilThreeQuartersOfTheWayAndThenIsTheFirstRadars) {
  const SceneConfig config = equator_config(40000);
  const RadarPlace near[] = {east(14.9, 40000), east(30, 40000)};
  EXPECT_EQ(next_window(config, window_of(config), near, near).origin.longitude_deg, 0);
  const RadarPlace far[] = {east(15.1, 40000), east(30, 40000)};
  EXPECT_EQ(next_window(config, window_of(config), far, far).origin.longitude_deg,
            far[0].position.longitude_deg);
}

TEST(FlightWindow, WithAnAreaOnlyTheOriginMoves) {
  SceneConfig config = equator_config(40000);
  config.world.terrain.area = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const RadarPlace near = east(19.9, 40000);
  EXPECT_FALSE(due(config, near));
  const RadarPlace far = east(20.1, 40000);
  EXPECT_TRUE(due(config, far));
}

TEST(FlightWindow, SwitchedOffIsNeverDue) {
  SceneConfig config = equator_config(40000);
  config.flight.enabled = false;
  const RadarPlace far = east(500, 40000);
  EXPECT_FALSE(due(config, far));
}

TEST(FlightWindow, ARangeBeyondTheSceneFilesIsNotFollowedUnlessAllowed) {
  SceneConfig config = equator_config(40000);
  const RadarPlace longer = east(0, 200000);
  EXPECT_FALSE(due(config, longer));
  config.flight.max_reach_km = 100;
  EXPECT_TRUE(due(config, longer));
  EXPECT_EQ(next(config, longer, longer).reaches[0].radius_m, 125000);
}

TEST(FlightWindow, PostsAreThoseOfTheRectangleAroundAllReaches) {
  SceneWindow window;
  window.reaches = {{{0, 0}, 10000}, {{1, 0}, 10000}};
  EXPECT_NEAR(window_posts(window, 100), 1311.95 * 200, 10) << "131.195 km x 20 km";
}

}  // namespace
}  // namespace obliq::test
