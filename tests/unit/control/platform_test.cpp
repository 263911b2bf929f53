// [[platform]] and what rides on it: lever arms in closed form, and how mistakes of a scene are answered.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/control/mount.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::platform_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLatitude_deg = 47;

/// Metres a degree along the meridian and along the parallel: the ellipsoid's own radii (WGS84), which the
/// code does not use.
double northward_m(double height_m) {
  const double s = std::sin(kLatitude_deg * kDegree);
  constexpr double kE2 = 6.69437999014e-3;
  return (6378137 * (1 - kE2) / std::pow(1 - kE2 * s * s, 1.5) + height_m) * kDegree;
}
double eastward_m(double height_m) {
  const double s = std::sin(kLatitude_deg * kDegree);
  constexpr double kE2 = 6.69437999014e-3;
  return (6378137 / std::sqrt(1 - kE2 * s * s) + height_m) * std::cos(kLatitude_deg * kDegree) * kDegree;
}

PoseSettings ship(double heading_deg, double roll_deg, double pitch_deg) {
  PoseSettings p;
  p.latitude_deg = kLatitude_deg;
  p.longitude_deg = 9;
  p.height_m = 500;
  p.heading_deg = heading_deg;
  p.roll_deg = roll_deg;
  p.pitch_deg = pitch_deg;
  return p;
}

struct Place {
  double north_m, east_m, up_m;
};
Place place_of(const PoseSettings& p) {
  return {(p.latitude_deg - kLatitude_deg) * northward_m(500), (p.longitude_deg - 9) * eastward_m(500),
          p.height_m - 500};
}

void expect_at(const PoseSettings& p, double north_m, double east_m, double up_m) {
  const Place at = place_of(p);
  EXPECT_NEAR(at.north_m, north_m, 2e-3);
  EXPECT_NEAR(at.east_m, east_m, 2e-3);
  EXPECT_NEAR(at.up_m, up_m, 2e-3);
}

TEST(Riding, AnArmTurnsWithHeadingPitchAndRoll) {
  const double s = std::sin(30 * kDegree), c = std::cos(30 * kDegree);
  const Mount bow{.forward_m = 40}, wing{.right_m = 15}, mast{.up_m = 20};
  expect_at(riding(ship(0, 0, 0), bow, {}), 40, 0, 0);
  expect_at(riding(ship(90, 0, 0), bow, {}), 0, 40, 0);
  expect_at(riding(ship(90, 0, 0), wing, {}), -15, 0, 0);
  expect_at(riding(ship(0, 0, 30), bow, {}), 40 * c, 0, 40 * s);                  // the nose goes up
  expect_at(riding(ship(0, 0, 30), mast, {}), -20 * s, 0, 20 * c);                // and the mast back
  expect_at(riding(ship(0, 30, 0), wing, {}), 0, 15 * c, -15 * s);                // the right wing goes down
  expect_at(riding(ship(0, 30, 0), mast, {}), 0, 20 * s, 20 * c);                 // and the mast to the right
  expect_at(riding(ship(0, 30, 30), wing, {}), s * 15 * s, 15 * c, -15 * s * c);  // first roll, then pitch
  expect_at(riding(ship(180, 30, 30), wing, {}), -s * 15 * s, -15 * c, -15 * s * c);
}

TEST(Riding, TheSectorsCentreGoesWithTheNoseAndTheTiltIsTheAntennas) {
  PoseSettings aim = ship(100, 0, 0);
  aim.bearing_deg = 130;
  aim.tilt_deg = -4;
  const PoseSettings pose = riding(ship(350, 20, -10), {}, aim);
  EXPECT_NEAR(pose.bearing_deg, 20, 1e-12);
  EXPECT_EQ(pose.tilt_deg, -4);
  EXPECT_EQ(pose.heading_deg, 350);
  EXPECT_EQ(pose.roll_deg, 20);
  EXPECT_EQ(pose.latitude_deg, kLatitude_deg) << "to the bit, without an arm";
}

TEST(Riding, OverGroundTheArmAddsToTheHeight) {
  PoseSettings low = ship(0, 0, 0);
  low.height_reference = HeightReference::ground;
  const PoseSettings pose = riding(low, {.forward_m = 10, .up_m = 3}, {});
  EXPECT_EQ(pose.height_m, 503);
  EXPECT_EQ(pose.height_reference, HeightReference::ground);
}

constexpr auto kShip =
    "[[platform]]\nname = \"ship\"\nlatitude_deg = 33\nlongitude_deg = -99.5\nheight_m = 700\n"
    "heading_deg = 90\nroll_deg = 10\n";
constexpr auto kRider =
    "[[radar]]\nname = \"bow\"\nplatform = \"ship\"\n[radar.mount]\nforward_m = 30\n"
    "look_deg = -20\n[radar.antenna]\ntilt_deg = -3\n";

class Platforms : public SceneFile {
 protected:
  static std::string scene(const std::string& rest) { return std::string(kFlat) + rest; }
};

TEST_F(Platforms, RidersStandWhereTheirPlatformIsAndPrintedScenesMeanTheSame) {
  const std::string text = scene(std::string(kShip) + kRider +
                                 "[[radar]]\nname = \"free\"\n[radar.antenna]\n"
                                 "latitude_deg = 33.1\nlongitude_deg = -99\n");
  const SceneConfig config = read(text);
  ASSERT_EQ(config.radars.size(), 2u);
  const RadarConfig& bow = config.radars[0];
  ASSERT_TRUE(bow.platform);
  EXPECT_EQ(bow.platform->name, "ship");
  EXPECT_NEAR(bow.pose.bearing_deg, 70, 1e-12);
  EXPECT_EQ(bow.pose.tilt_deg, -3);
  EXPECT_EQ(bow.pose.roll_deg, 10);
  EXPECT_GT(bow.pose.longitude_deg, -99.5);
  EXPECT_FALSE(config.radars[1].platform);
  const SceneConfig again = read(print_config(config));
  ASSERT_EQ(again.radars.size(), 2u);
  EXPECT_EQ(again.radars[0].pose, bow.pose);
  EXPECT_EQ(again.radars[0].mount.forward_m, 30);
  EXPECT_EQ(read(text, {"bow:mount.forward_m=0"}).radars[0].pose.longitude_deg, -99.5);
}

TEST_F(Platforms, MistakesAreNamed) {
  const std::string ship = kShip;
  const std::string rider = kRider;
  EXPECT_SAYS(complaint(scene(ship + ship + rider)), "platform.name: found a second \"ship\"");
  EXPECT_SAYS(complaint(scene(ship + "[[radar]]\nname = \"ship\"\n")),
              "radar.name: found \"ship\", a platform's");
  EXPECT_SAYS(complaint(scene(rider)),
              "radar.platform: found \"ship\"; allowed: the name of a [[platform]]; there is none");
  EXPECT_SAYS(complaint(scene(ship + "[[radar]]\nplatform = \"shop\"\n")),
              "radar.platform: found \"shop\"; allowed: \"ship\"");
  EXPECT_SAYS(complaint(scene(ship + rider + "height_m = 30\n")),
              "antenna.height_m: found a place of its own");
  EXPECT_SAYS(complaint(scene("[[radar]]\n[radar.mount]\nup_m = 3\n")),
              "mount: found a radar that rides on nothing");
  EXPECT_SAYS(complaint(scene("[[platform]]\nlatitude_deg = 1\nlongitude_deg = 1\n[[radar]]\n")),
              "platform.name: found nothing");
  EXPECT_SAYS(complaint(scene("[[platform]]\nname = \"s\"\nlatitude_deg = 1\n[[radar]]\n")),
              "platform.longitude_deg: found nothing");
  EXPECT_SAYS(complaint(scene(ship + "pitch_deg = 61\n" + rider)), "platform.pitch_deg: found 61");
  EXPECT_SAYS(complaint(scene(ship + "roll = 6\n" + rider)), "platform.roll: ");
  EXPECT_SAYS(complaint(scene(ship + "[[radar]]\nplatform = \"ship\"\n[radar.mount]\nup_m = 3000\n")),
              "mount.up_m: found 3000");
}

}  // namespace
}  // namespace obliq::platform_test
