#include "server/flight/pose_time_line.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/control/scene_file.h"
#include "server/flight/window.h"

namespace obliq::test::pose_time_line_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStart_ns = 7'000'000'000'000;  // the server has been up for a while

PoseSettings pose(std::int64_t sim_ms, double latitude_deg, double bearing_deg = 0, std::uint64_t id = 0) {
  PoseSettings p;
  p.latitude_deg = latitude_deg;
  p.bearing_deg = bearing_deg;
  p.sim_time_ns = sim_ms * kMs;
  p.pose_id = id;
  return p;
}

std::int64_t server(double ms) { return kStart_ns + static_cast<std::int64_t>(ms * 1e6); }

TEST(PoseTimeLine, APoseWithoutSimTimeAppliesAtOnceAndStays) {
  PoseTimeLine line(pose(0, 33));
  EXPECT_EQ(line.at(server(0)).pose.latitude_deg, 33);
  EXPECT_EQ(line.at(server(0)).received_ns, 0);
  line.set(pose(0, 34), server(10));
  EXPECT_EQ(line.at(server(10)).pose.latitude_deg, 34);
  EXPECT_EQ(line.at(server(1e9)).pose.latitude_deg, 34);
  EXPECT_EQ(line.at(server(20)).received_ns, server(10));
}

TEST(PoseTimeLine, SteadyPosesAreShownOneIntervalLateAndJoinedUp) {
  // 50 Hz, a metre of latitude (1e-5 degrees) a pose; the clocks have nothing to do with each other.
  PoseTimeLine line(pose(0, 33));
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(
        line.add(pose(20 * i - 500000, 33 + 1e-5 * i, 0, static_cast<std::uint64_t>(i)), server(20 * i)));
    if (i == 0) continue;
    for (const double after_ms : {0.0, 5.0, 10.0, 15.0, 19.9}) {
      const PoseAt at = line.at(server(20 * i + after_ms));
      const double shown = i - 1 + after_ms / 20;
      ASSERT_NEAR(at.pose.latitude_deg, 33 + 1e-5 * shown, 1e-9) << i << " " << after_ms;  // 0.1 mm
      ASSERT_NEAR(static_cast<double>(at.pose.sim_time_ns), (20 * shown - 500000) * 1e6, 1.0);
      ASSERT_EQ(at.pose.pose_id, static_cast<std::uint64_t>(i - 1));
    }
  }
}

TEST(PoseTimeLine, PastTheNewestItHoldsAndNeverExtrapolates) {
  PoseTimeLine line(pose(0, 33));
  for (int i = 0; i < 10; ++i) line.add(pose(20 * i, 33 + 1e-5 * i), server(20 * i));
  const double newest_deg = 33 + 1e-5 * 9;
  EXPECT_LT(line.at(server(190)).pose.latitude_deg, newest_deg);
  EXPECT_EQ(line.at(server(201)).pose.latitude_deg, newest_deg);
  EXPECT_EQ(line.at(server(5000)).pose.latitude_deg, newest_deg);
  EXPECT_EQ(line.at(server(5000)).pose.sim_time_ns, 180 * kMs);
}

TEST(PoseTimeLine, UnevenDelaysDoNotShakeTheShownPose) {
  // Delays from 0 to 15 ms in a fixed disorder: what is shown still moves evenly, within the tenth that the
  // shown time may run fast or slow, and never holds.
  PoseTimeLine line(pose(0, 33));
  const int delay_ms[] = {0, 7, 3, 15, 1, 11, 5, 9, 2, 13};
  double last_deg = 0;
  for (int i = 0; i < 400; ++i) {
    line.add(pose(20 * i, 33 + 1e-5 * i), server(20 * i + delay_ms[i % 10]));
    const double shown_deg = line.at(server(20 * i + 16)).pose.latitude_deg;
    if (i > 100) {
      EXPECT_NEAR(shown_deg - last_deg, 1e-5, 0.11e-5) << i;
    }
    last_deg = shown_deg;
  }
}

TEST(PoseTimeLine, LatePosesAreCountedAndChangeNothing) {
  PoseTimeLine line(pose(0, 33));
  EXPECT_TRUE(line.add(pose(1000, 33), server(0)));
  EXPECT_FALSE(line.add(pose(999, 50), server(1)));
  EXPECT_EQ(line.late(), 1u);
  EXPECT_EQ(line.at(server(1e4)).pose.latitude_deg, 33);
  EXPECT_TRUE(line.add(pose(1000, 34), server(2))) << "the same moment, mended";
  EXPECT_EQ(line.at(server(1e4)).pose.latitude_deg, 34);
}

TEST(PoseTimeLine, AClockSetBackBeginsAnewAfterTwoSecondsOfLatePosesOrWithAnotherController) {
  PoseTimeLine line(pose(0, 33));
  line.add(pose(1'000'000, 33), server(0));
  int late = 0;
  while (!line.add(pose(late, 40), server(late))) ++late;
  EXPECT_EQ(late + 1, PoseTimeLine::kMostLate);
  EXPECT_EQ(line.at(server(5000)).pose.latitude_deg, 40);
  line.add(pose(2'000'000, 41), server(6000));
  line.restart();
  EXPECT_TRUE(line.add(pose(5, 42), server(6001)));
  EXPECT_EQ(line.at(server(6001)).pose.latitude_deg, 42);
}

TEST(PoseTimeLine, IsStaleOnceTheNewestsValidityIsOver) {
  PoseTimeLine line(pose(0, 33));
  PoseSettings p = pose(0, 33);
  p.valid_s = 0.5;
  line.add(p, server(0));
  EXPECT_FALSE(line.at(server(499)).stale);
  EXPECT_TRUE(line.at(server(501)).stale);
  p.sim_time_ns = 600 * kMs;
  line.add(p, server(600));
  EXPECT_FALSE(line.at(server(1000)).stale);
  p.valid_s = 0;
  line.set(p, server(2000));
  EXPECT_FALSE(line.at(server(1e9)).stale) << "0: for ever";
}

TEST(PoseTimeLine, AnAntennaIsTurnedInAllPosesAtOnceAndItsPlatformGoesOn) {
  PoseTimeLine line(pose(0, 33));
  for (int i = 0; i < 3; ++i) {
    PoseSettings p = pose(20 * i, 33 + 1e-5 * i, 350 + 10 * i);
    p.heading_deg = 350 + 10 * i;
    line.add(p, server(20 * i));
  }
  const PoseAt before = line.at(server(50));
  PoseSettings as = line.newest();
  as.bearing_deg = 100;
  as.tilt_deg = -3;
  line.aim(as);
  const PoseAt after = line.at(server(50));
  EXPECT_EQ(after.pose.latitude_deg, before.pose.latitude_deg);
  EXPECT_EQ(after.pose.sim_time_ns, before.pose.sim_time_ns);
  EXPECT_EQ(after.received_ns, before.received_ns);
  EXPECT_EQ(after.pose.tilt_deg, -3);
  // The newest pose looked along its heading of 370; the antenna looks 90 to the right of it from now on.
  EXPECT_NEAR(std::remainder(after.pose.bearing_deg - before.pose.bearing_deg - 90, 360), 0, 1e-9);
  EXPECT_EQ(line.at(server(1000)).pose.bearing_deg, 100);
}

TEST(PoseTimeLine, ExtremeTimesAreTaken) {
  PoseTimeLine line(pose(0, 33));
  PoseSettings p;
  for (const std::int64_t ns : {-4'000'000'000'000'000'000, std::int64_t{0}, 4'000'000'000'000'000'000}) {
    p.sim_time_ns = ns;
    EXPECT_TRUE(line.add(p, server(0)));
    EXPECT_EQ(line.at(server(1)).pose.sim_time_ns, ns);
  }
}

TEST(PoseBetween, TurnsTheShorterWay) {
  EXPECT_NEAR(between(pose(0, 0, 350), pose(0, 0, 10), 0.25).bearing_deg, -5, 1e-12);
  EXPECT_NEAR(between(pose(0, 0, 10), pose(0, 0, -10), 0.5).bearing_deg, 0, 1e-12);
  EXPECT_NEAR(between(pose(0, 0, 170), pose(0, 0, -170), 0.5).bearing_deg, 180, 1e-12);
}

TEST(PoseBetween, IsStraightInSpace) {
  PoseSettings a = pose(0, 60);
  PoseSettings b = pose(0, 60);
  a.longitude_deg = 179.99;
  b.longitude_deg = -179.99;  // 1.1 km apart, across the antimeridian
  const PoseSettings middle = between(a, b, 0.5);
  EXPECT_NEAR(std::abs(middle.longitude_deg), 180, 1e-9);
  // A chord of c sinks c^2 / 8 R below the arc: 2 cm; and so a little north of the parallel.
  const double chord_m = 0.02 * 111195 * 0.5;
  EXPECT_NEAR(a.height_m - middle.height_m, chord_m * chord_m / 8 / 6371000, 2e-3);
  EXPECT_EQ(between(a, b, 0).longitude_deg, 179.99);
  EXPECT_EQ(between(a, b, 1).longitude_deg, -179.99);
}

TEST(PoseBetween, AnAntennaThatOnlyTurnsStaysWhereItIsBitForBit) {
  const PoseSettings a = pose(0, 33.123456789, 10);
  const PoseSettings b = pose(0, 33.123456789, 20);
  EXPECT_EQ(between(a, b, 0.3).latitude_deg, a.latitude_deg);
  EXPECT_EQ(between(a, b, 0.3).height_m, a.height_m);
}

using Time = Speedometer::Time;

std::vector<RadarPlace> at(double longitude_deg, double latitude_deg) {
  return {{{longitude_deg, latitude_deg}, 1000}};
}
Time second(double s) { return Time(std::chrono::milliseconds(static_cast<int>(1000 * s))); }

TEST(Speedometer, GoesOnAsTheRadarsDo) {
  Speedometer speed;
  speed.note(at(10, 50), second(100));
  EXPECT_EQ(speed.ahead(at(10, 50), 60, second(100))[0].position.longitude_deg, 10) << "nothing is known yet";
  speed.note(at(10.001, 50.002), second(101));
  const LonLat later = speed.ahead(at(10.001, 50.002), 10, second(101))[0].position;
  EXPECT_NEAR(later.longitude_deg, 10.011, 1e-9);
  EXPECT_NEAR(later.latitude_deg, 50.022, 1e-9);
}

TEST(Speedometer, PosesInQuickSuccessionDoNotShakeIt) {
  Speedometer speed;
  for (int i = 0; i <= 120; ++i) speed.note(at(10 + 1e-5 * i + (i % 2) * 1e-6, 50), second(100 + i / 60.0));
  // 60 poses a second of 1e-5 degrees each; the jitter of 1e-6 counts for half a second at least.
  EXPECT_NEAR(speed.ahead(at(0, 50), 10, second(102))[0].position.longitude_deg, 6e-3, 5e-5);
}

TEST(Speedometer, CrossesTheAntimeridian) {
  Speedometer speed;
  speed.note(at(179.9995, 0), second(100));
  speed.note(at(-179.9995, 0), second(101));
  EXPECT_NEAR(distance_m(speed.ahead(at(-179.9995, 0), 10, second(101))[0].position, {-179.9895, 0}), 0, 0.1);
}

TEST(Speedometer, RadarsOfWhichNothingIsHeardForTwoSecondsStandStill) {
  Speedometer speed;
  speed.note(at(10, 50), second(100));
  speed.note(at(11, 50), second(101));  // a jump, or the last of a flight
  EXPECT_NEAR(speed.ahead(at(11, 50), 10, second(103))[0].position.longitude_deg, 21, 1e-9);
  EXPECT_EQ(speed.ahead(at(11, 50), 10, second(103.001))[0].position.longitude_deg, 11);
  speed.note(at(11, 50), second(103.1));
  EXPECT_NEAR(speed.ahead(at(11, 50), 10, second(103.2))[0].position.longitude_deg, 11, 1e-9);
}

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
}  // namespace obliq::test::pose_time_line_test
