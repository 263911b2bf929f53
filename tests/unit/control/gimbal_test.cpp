// What a gimbal's limits do to where an antenna looks: by hand on a level platform, by rotations written out
// here on one that rolls and pitches.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "server/control/mount.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::gimbal_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Mount mount(double left_deg, double right_deg, double down_deg = -90, double up_deg = 90,
            double look_deg = 0) {
  return {.look_deg = look_deg, .gimbal = {left_deg, right_deg, down_deg, up_deg}};
}

PoseSettings looking(double heading_deg, double centre_deg, double tilt_deg, double roll_deg = 0,
                     double pitch_deg = 0) {
  PoseSettings pose;
  pose.heading_deg = heading_deg;
  pose.bearing_deg = std::remainder(heading_deg + centre_deg, 360.0);
  pose.tilt_deg = tilt_deg;
  pose.roll_deg = roll_deg;
  pose.pitch_deg = pitch_deg;
  return pose;
}

RadarSettings sector(double sector_deg, bool stabilised = true) {
  RadarSettings settings;
  settings.sector_deg = sector_deg;
  settings.beam.stabilised = stabilised;
  return settings;
}

struct Angles {
  double azimuth_deg, elevation_deg;
};

/// Of a direction in the platform's own axes: yaw, pitch and roll undone one after the other.
Angles in_platform(const PoseSettings& pose, double azimuth_deg, double elevation_deg) {
  double ahead = std::cos(elevation_deg * kDegree) * std::cos(azimuth_deg * kDegree);
  double right = std::cos(elevation_deg * kDegree) * std::sin(azimuth_deg * kDegree);
  double up = std::sin(elevation_deg * kDegree);
  const double cp = std::cos(pose.pitch_deg * kDegree), sp = std::sin(pose.pitch_deg * kDegree);
  const double nose = ahead * cp + up * sp;
  const double lifted = up * cp - ahead * sp;
  const double cr = std::cos(pose.roll_deg * kDegree), sr = std::sin(pose.roll_deg * kDegree);
  const double wing = right * cr - lifted * sr;
  const double top = lifted * cr + right * sr;
  return {std::atan2(wing, nose) / kDegree, std::asin(top) / kDegree};
}

TEST(Gimbal, WithoutLimitsNoBitMoves) {
  const PoseSettings pose = looking(123.456, 77.7, -3.3, 20, 5);
  EXPECT_EQ(held_by({}, sector(60), pose), pose);
  EXPECT_EQ(limit_met({}, sector(60), pose), "");
}

TEST(Gimbal, WithinItsLimitsNoBitMoves) {
  const PoseSettings pose = looking(123.456, 29.9, -3.3);
  EXPECT_EQ(held_by(mount(-60, 60, -30, 10), sector(60), pose), pose);
  EXPECT_EQ(limit_met(mount(-60, 60, -30, 10), sector(60), pose), "");
  const PoseSettings exactly = looking(0, 30, 10);
  EXPECT_EQ(held_by(mount(-60, 60, -30, 10), sector(60), exactly), exactly);
}

TEST(Gimbal, ALevelAntennaStandsWithItsEdgeAtTheLimit) {
  const Mount nose = mount(-60, 60, -30, 10);
  const PoseSettings asked = looking(350, 50, -40);
  const PoseSettings held = held_by(nose, sector(60), asked);
  EXPECT_NEAR(std::remainder(held.bearing_deg - 350, 360.0), 30, 1e-9);
  EXPECT_NEAR(held.tilt_deg, -30, 1e-9);
  EXPECT_EQ(
      limit_met(nose, sector(60), asked),
      "azimuth at its limit of 60 deg, 20.0 deg short; elevation at its limit of -30 deg, 10.0 deg short");
  EXPECT_NEAR(held_by(nose, sector(60), looking(0, -80, 0)).bearing_deg, -30, 1e-9);
  EXPECT_NEAR(held_by(nose, sector(60), looking(0, 0, 25)).tilt_deg, 10, 1e-9);
}

TEST(Gimbal, LimitsCountFromWhereTheMountLooks) {
  const Mount tail = mount(-45, 45, -90, 90, 180);
  EXPECT_EQ(limit_met(tail, sector(30), looking(10, -175, 0)), "");
  EXPECT_NEAR(std::remainder(held_by(tail, sector(30), looking(10, 90, 0)).bearing_deg - 10, 360.0), 150,
              1e-9);
  EXPECT_NEAR(std::remainder(held_by(tail, sector(30), looking(10, -90, 0)).bearing_deg - 10, 360.0), -150,
              1e-9);
}

TEST(Gimbal, ASectorThatIsTooWideIsInTheMiddleAndSaysSo) {
  const Mount narrow = mount(-20, 40);
  EXPECT_NEAR(held_by(narrow, sector(120), looking(0, 77, 0)).bearing_deg, 10, 1e-9);
  EXPECT_EQ(limit_met(narrow, sector(120), looking(0, 77, 0)),
            "azimuth: the sector needs 120.0 deg, the gimbal has 60");
}

TEST(Gimbal, AStabilisedAntennaNeedsMoreWhereItsPlatformRolls) {
  // It looks level to the right while the right side is 30 degrees down: 30 degrees up for the gimbal.
  const PoseSettings asked = looking(0, 90, 0, 30);
  const Mount wing = mount(-180, 180, -60, 20);
  EXPECT_NEAR(held_by(wing, sector(1e-3), asked).tilt_deg, -10, 1e-3);
  EXPECT_EQ(limit_met(wing, sector(1e-3), asked), "elevation at its limit of 20 deg, 10.0 deg short");
  EXPECT_EQ(limit_met(wing, sector(1e-3, false), asked), "") << "one that rolls along needs nothing";
}

TEST(Gimbal, AllRoundItHasNoStopInAzimuth) {
  const Mount down = mount(-180, 180, -30, 10);
  EXPECT_EQ(held_by(down, sector(60), looking(0, 170, 0)).bearing_deg, 170);
  EXPECT_EQ(held_by(down, sector(360), looking(0, 77, 0)).bearing_deg, 77);
  EXPECT_EQ(limit_met(down, sector(360), looking(0, 170, -31)),
            "elevation at its limit of -30 deg, 1.0 deg short");
}

TEST(Gimbal, AnAutomaticTiltIsNotHeld) {
  PoseSettings asked = looking(0, 80, -50);
  asked.tilt_auto = true;
  EXPECT_EQ(held_by(mount(-60, 60, -10, 10), sector(20), asked).tilt_deg, -50);
  EXPECT_EQ(limit_met(mount(-60, 60, -10, 10), sector(20), asked),
            "azimuth at its limit of 60 deg, 30.0 deg short");
}

TEST(Gimbal, OfBarsTheFirstThatIsNotReachedIsSaid) {
  RadarSettings settings = sector(20);
  settings.scan_bars_deg = {-5, -25, -35};
  const Mount nose = mount(-60, 60, -20, 10);
  EXPECT_EQ(limit_met(nose, settings, looking(0, 0, -80)),
            "elevation at its limit of -20 deg, 60.0 deg short")
      << "whole frames have no bars";
  settings.scan_mode = ScanMode::sector;
  EXPECT_EQ(limit_met(nose, settings, looking(0, 0, -80)),
            "elevation at its limit of -20 deg, 5.0 deg short");
}

TEST(Gimbal, WhereverItIsAskedToLookItStaysWithinItsLimits) {
  std::mt19937_64 random(20261127);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  int held_count = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Mount nose = mount(any(-90, -40), any(40, 90), any(-60, -20), any(10, 40));
    const double sector_deg = any(1, 60);
    const PoseSettings asked =
        looking(any(-180, 180), any(-70, 70), any(-40, 15), any(-30, 30), any(-20, 20));
    const PoseSettings held = held_by(nose, sector(sector_deg), asked);
    const std::string said = limit_met(nose, sector(sector_deg), asked);
    const bool is_said = !said.empty();
    EXPECT_EQ(is_said, !(held == asked)) << trial;
    if (said.find("needs") != std::string::npos) continue;  // more than there is
    held_count += is_said ? 1 : 0;
    const double centre_deg = held.bearing_deg - held.heading_deg;
    for (const double offset : {-sector_deg / 2, 0.0, sector_deg / 2}) {
      const Angles needed = in_platform(held, centre_deg + offset, held.tilt_deg);
      EXPECT_GT(needed.azimuth_deg, nose.gimbal.azimuth_min_deg - 0.05) << trial;
      EXPECT_LT(needed.azimuth_deg, nose.gimbal.azimuth_max_deg + 0.05) << trial;
      EXPECT_GT(needed.elevation_deg, nose.gimbal.elevation_min_deg - 0.05) << trial;
      EXPECT_LT(needed.elevation_deg, nose.gimbal.elevation_max_deg + 0.05) << trial;
    }
  }
  EXPECT_GT(held_count, 300);
  EXPECT_LT(held_count, 1900);
}

class GimbalInASceneFile : public SceneFile {};

TEST_F(GimbalInASceneFile, IsReadAndItsMistakesAreNamed) {
  const std::string head = std::string(kFlat) +
                           "[[platform]]\nname = \"ship\"\nlatitude_deg = 33.0\nlongitude_deg = -99.5\n"
                           "[[radar]]\nname = \"a\"\nplatform = \"ship\"\n[radar.mount]\n";
  const Mount found =
      read(head +
           "azimuth_min_deg = -60\nazimuth_max_deg = 70\nelevation_min_deg = -30\nelevation_max_deg = 5\n")
          .radars[0]
          .mount;
  EXPECT_EQ(found.gimbal, (GimbalLimits{-60, 70, -30, 5}));
  EXPECT_SAYS(complaint(head + "azimuth_min_deg = 10\nazimuth_max_deg = 5\n"),
              "mount.azimuth_min_deg: found 10.0; allowed: below mount.azimuth_max_deg, 5.0");
  EXPECT_SAYS(complaint(head + "elevation_max_deg = -90\n"), "mount.elevation_min_deg: found -90.0");
  EXPECT_SAYS(complaint(head + "elevation_max_deg = nan\n"), "mount.elevation_max_deg");
}

}  // namespace
}  // namespace obliq::gimbal_test
