// An antenna's velocity: given with its poses, or from them by their own sim times.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/flight/pose_time_line.h"

namespace obliq::test::velocity_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLatitude_deg = 47;

/// The server's clock, which has nothing to do with the controller's.
std::int64_t server(double ms) { return 7'000'000'000'000 + std::llround(ms * 1e6); }

/// Metres a degree along the meridian and along the parallel at a height: the ellipsoid's own radii (WGS84),
/// which the code does not use.
double northward_m(double latitude_deg, double height_m) {
  const double s = std::sin(latitude_deg * kDegree);
  constexpr double kE2 = 6.69437999014e-3;
  return (6378137 * (1 - kE2) / std::pow(1 - kE2 * s * s, 1.5) + height_m) * kDegree;
}
double eastward_m(double latitude_deg, double height_m) {
  const double s = std::sin(latitude_deg * kDegree);
  constexpr double kE2 = 6.69437999014e-3;
  return (6378137 / std::sqrt(1 - kE2 * s * s) + height_m) * std::cos(latitude_deg * kDegree) * kDegree;
}

/// One that flies 120 m/s north, -80 m/s east and 15 m/s up.
PoseSettings flown(std::int64_t sim_ms) {
  const double t_s = static_cast<double>(sim_ms) * 1e-3;
  PoseSettings p;
  p.height_m = 3000 + 15 * t_s;
  p.latitude_deg = kLatitude_deg + 120 * t_s / northward_m(kLatitude_deg, 3000);
  p.longitude_deg = 9 - 80 * t_s / eastward_m(kLatitude_deg, 3000);
  p.sim_time_ns = sim_ms * kMs;
  return p;
}

PoseSettings with_velocity(PoseSettings p, double north, double east, double up) {
  p.velocity_north_m_s = north;
  p.velocity_east_m_s = east;
  p.velocity_up_m_s = up;
  return p;
}

void expect_velocity(const PoseSettings& p, double north, double east, double up, double within_m_s) {
  ASSERT_TRUE(p.has_velocity());
  EXPECT_NEAR(p.velocity_north_m_s.value(), north, within_m_s);
  EXPECT_NEAR(p.velocity_east_m_s.value(), east, within_m_s);
  EXPECT_NEAR(p.velocity_up_m_s.value(), up, within_m_s);
}

TEST(Velocity, IsThatOfThePosesByTheirOwnClockWhateverTheServersDoes) {
  PoseTimeLine line(flown(0));
  // The controller's clock runs 8 % slow: 20 ms of it take 21.6 ms. The shown time follows; the velocity is
  // of sim time.
  for (int i = 0; i < 60; ++i) {
    line.add(flown(20 * i), server(21.6 * i));
    if (i == 0) continue;
    for (const double after_ms : {0.0, 7.0, 21.0}) {
      SCOPED_TRACE(i);
      // Of single precision would be 0.4 m a 20 ms, 20 m/s; that the parallel narrows is 0.1 m/s in 24 s.
      expect_velocity(line.at(server(21.6 * i + after_ms)).pose, 120, -80, 15, 0.02);
    }
  }
}

TEST(Velocity, StaysWhereTheAntennaWaitsAtTheNewestPoseAndWithOneThatStandsItIsNone) {
  PoseTimeLine line(flown(0));
  line.add(flown(0), server(0));
  line.add(flown(20), server(20));
  expect_velocity(line.at(server(5000)).pose, 120, -80, 15, 0.02);
  EXPECT_EQ(line.at(server(5000)).pose.latitude_deg, flown(20).latitude_deg) << "it is not flown on with it";
  PoseSettings there = flown(20);
  there.sim_time_ns = 40 * kMs;
  line.add(there, server(40));
  expect_velocity(line.at(server(5000)).pose, 0, 0, 0, 0);
}

TEST(Velocity, OfOnePoseOfANewTimeLineOrOfPosesWithoutATimeThereIsNone) {
  PoseTimeLine line(flown(0));
  EXPECT_FALSE(line.at(server(0)).pose.has_velocity());
  line.add(flown(0), server(0));
  EXPECT_FALSE(line.at(server(1)).pose.has_velocity());
  line.add(flown(20), server(20));
  EXPECT_TRUE(line.at(server(30)).pose.has_velocity());
  line.restart();
  line.add(flown(40), server(40));
  EXPECT_FALSE(line.at(server(50)).pose.has_velocity()) << "across a new time line";
  line.add(flown(40 + 2001), server(2041));
  EXPECT_FALSE(line.at(server(2050)).pose.has_velocity()) << "further apart than poses are joined up";
  line.set(flown(2060), server(2060));
  line.set(flown(2080), server(2080));
  EXPECT_FALSE(line.at(server(2090)).pose.has_velocity());
  EXPECT_FALSE(line.newest().has_velocity()) << "as it was sent";
}

TEST(Velocity, ThatIsGivenIsShownAndGoesEvenlyFromOneToTheNext) {
  PoseTimeLine line(flown(0));
  line.set(with_velocity(flown(0), 7, 0, -2), server(0));
  expect_velocity(line.at(server(10)).pose, 7, 0, -2, 0);
  line.add(with_velocity(flown(0), 100, 10, 0), server(100));
  line.add(with_velocity(flown(20), 110, 30, 4), server(120));
  // Shown 20 ms late: at the arrival of the second it is the first's time.
  expect_velocity(line.at(server(125)).pose, 102.5, 15, 1, 1e-9);
  expect_velocity(line.at(server(500)).pose, 110, 30, 4, 0);
  // One that is not given is not made of the last that was: it comes from the places.
  line.add(flown(40), server(140));
  expect_velocity(line.at(server(150)).pose, 120, -80, 15, 0.02);
}

TEST(Velocity, UpwardsOverGroundIsTheChangeOfHeightAndBetweenTwoKindsOfHeightsThereIsNone) {
  PoseSettings a = flown(0), b = flown(1000);
  a.height_reference = b.height_reference = HeightReference::ground;
  PoseTimeLine line(a);
  line.add(a, server(0));
  line.add(b, server(1000));
  const PoseSettings shown = line.at(server(1500)).pose;
  EXPECT_NEAR(shown.velocity_up_m_s.value(), 15, 1e-9) << "and not that of the chord";
  // On the ground below: 3 km further in.
  EXPECT_NEAR(shown.velocity_north_m_s.value(), 120 * northward_m(47, 0) / northward_m(47, 3000), 0.02);
  PoseSettings c = flown(2000);
  line.add(c, server(2000));
  EXPECT_FALSE(line.at(server(2500)).pose.has_velocity());
}

TEST(Velocity, FasterThanAnythingFliesIsAJump) {
  PoseTimeLine line(flown(0));
  PoseSettings far = flown(20);
  far.latitude_deg += 1;
  line.add(flown(0), server(0));
  line.add(far, server(20));
  EXPECT_FALSE(line.at(server(30)).pose.has_velocity());
}

TEST(Velocity, IsAlongTheShownPlacesOwnNorthOnTheOtherSideOfTheAntimeridian) {
  PoseSettings a, b;
  a.latitude_deg = b.latitude_deg = 60;
  a.longitude_deg = 179.999;
  b.longitude_deg = -179.999;
  b.sim_time_ns = 1000 * kMs;
  PoseTimeLine line(a);
  line.add(a, server(0));
  line.add(b, server(1000));
  // A way of 111 m a second, straight: it climbs to b's parallel as much as it left a's, and is level
  // between.
  expect_velocity(line.at(server(1500)).pose, 0, 0.002 * eastward_m(60, 1000), 0, 1e-4);
}

TEST(Attitude, GoesEvenlyFromPoseToPose) {
  PoseSettings a = flown(0), b = flown(20);
  a.roll_deg = -10;
  b.roll_deg = 20;
  b.pitch_deg = 4;
  EXPECT_EQ(between(a, b, 0.5).roll_deg, 5);
  EXPECT_EQ(between(a, b, 0.25).pitch_deg, 1);
  EXPECT_TRUE(same_antenna(RadarSettings(), a,
                           [&] {
                             PoseSettings moved = with_velocity(a, 1, 2, 3);
                             moved.roll_deg = 50;
                             moved.pitch_deg = -50;
                             return moved;
                           }()))
      << "a stabilised antenna sees the same";
}

}  // namespace
}  // namespace obliq::test::velocity_test
