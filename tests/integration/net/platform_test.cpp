// Radars that ride on a platform: one pose moves all of them, and who may do what.
#include <gtest/gtest.h>

#include <thread>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/net/panel.h"
#include "server/net/server.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::platform_test {
namespace {

using client::Status;
using wire::kPoseClaim;
using wire::kSettingsClaim;

/// "bow" 100 m before and "stern" 100 m behind the middle of a ship on the equator, and "free" on its own.
std::vector<RadarConfig> radars() {
  const auto ship = std::make_shared<const PlatformConfig>(PlatformConfig{"ship", {}});
  std::vector<RadarConfig> all;
  for (const auto& [name, forward_m] : {std::pair{"bow", 100.0}, std::pair{"stern", -100.0}}) {
    RadarConfig& radar = all.emplace_back(small_radar(name));
    radar.platform = ship;
    radar.mount = {.forward_m = forward_m, .look_deg = forward_m < 0 ? 180.0 : 0.0};
    radar.settings.sector_deg = 60;
    if (forward_m < 0) radar.mount.gimbal = {-50, 50, -30, 10};
    radar.pose = riding_at_start(*ship, radar.mount, radar.pose);
  }
  all.push_back(small_radar("free"));
  return all;
}

class Ship : public testing::Test {
 protected:
  ~Ship() override {
    server.stop();
    thread.join();
  }
  client::Client connected(const std::string& name) {
    client::Client made;
    EXPECT_TRUE(is_ok(made.connect({"127.0.0.1", server.port()}, {.name = name})));
    return made;
  }
  static wire::RadarInfo info(client::Client& client, const std::string& radar) {
    wire::RadarInfo found;
    EXPECT_TRUE(is_ok(client.get_radar(radar, found)));
    return found;
  }
  static void expect_refused(const Status& status, std::uint32_t number, const std::string& part) {
    EXPECT_EQ(status.number, number) << status.sentence();
    EXPECT_NE(status.sentence().find(part), std::string::npos) << status.sentence();
  }
  static wire::Pose sailed(double longitude_deg, double heading_deg, std::int64_t sim_time_ns) {
    wire::Pose pose;
    pose.set_longitude_deg(longitude_deg);
    pose.set_heading_deg(heading_deg);
    pose.set_sim_time_ns(sim_time_ns);
    return pose;
  }

  PatternRenderer renderer;
  net::Server server{renderer, radars(), small_options()};
  std::thread thread{[this] { server.run(); }};
  client::Client host = connected("host");
  client::Client hand = connected("hand");
  wire::Ack ack;
};

constexpr double kDegree_m = 6378137 * 3.14159265358979323846 / 180;  // of longitude at the equator, height 0

TEST_F(Ship, OnePoseMovesAllItsRadarsAndNoOther) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  const std::string free_before = info(hand, "free").pose().SerializeAsString();
  wire::Pose pose = sailed(2, 90, 1'000'000'000);
  pose.set_height_m(0);
  pose.set_roll_deg(20);
  ASSERT_TRUE(is_ok(host.set_pose("ship", pose, ack)));
  EXPECT_EQ(ack.warnings_size(), 0);
  const wire::RadarInfo bow = info(hand, "bow");
  const wire::RadarInfo stern = info(hand, "stern");
  EXPECT_NEAR((bow.pose().longitude_deg() - 2) * kDegree_m, 100, 1e-3);
  EXPECT_NEAR((stern.pose().longitude_deg() - 2) * kDegree_m, -100, 1e-3);
  EXPECT_NEAR(bow.pose().bearing_deg(), 90, 1e-9);
  EXPECT_NEAR(stern.pose().bearing_deg(), -90, 1e-9);
  EXPECT_EQ(stern.pose().roll_deg(), 20);
  EXPECT_EQ(stern.pose().sim_time_ns(), 1'000'000'000);
  EXPECT_EQ(bow.platform(), "ship");
  EXPECT_EQ(bow.controller(), stern.controller());
  EXPECT_EQ(info(hand, "free").pose().SerializeAsString(), free_before);
  EXPECT_EQ(info(hand, "free").platform(), "");

  const wire::RadarInfo ship = info(host, "ship");
  EXPECT_EQ(ship.pose().longitude_deg(), 2);
  EXPECT_EQ(ship.pose().bearing_deg(), 90) << "its heading";
  EXPECT_EQ(ship.riders_size(), 2);
  EXPECT_TRUE(ship.controlled_by_you());
  EXPECT_FALSE(ship.has_settings());
  wire::RadarList list;
  ASSERT_TRUE(is_ok(hand.list_radars(list)));
  ASSERT_EQ(list.platforms_size(), 1);
  EXPECT_EQ(list.platforms(0), "ship");
  EXPECT_EQ(list.radars_size(), 3);
}

TEST_F(Ship, ItsPoseIsHeldAsOneAndItsRadarsSettingsEachByItself) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  expect_refused(hand.claim("ship", kPoseClaim), 102, "platform ship: pose is held by host");
  expect_refused(hand.claim("ship", kSettingsClaim), 100, "settings are its radars' own");
  expect_refused(hand.claim("bow", kPoseClaim), 100, "bow, which rides on platform ship; allowed: ship");
  ASSERT_TRUE(is_ok(hand.claim_control("bow"))) << "of a rider the settings alone";
  EXPECT_EQ(info(hand, "bow").settings_controller(), info(hand, "bow").settings_controller());
  EXPECT_EQ(info(hand, "bow").controller().rfind("host", 0), 0u);
  expect_refused(hand.set_pose("ship", sailed(1, 0, 1), ack), 102, "pose is held by host");

  // Where the antenna looks is the operator's.
  wire::Pose look;
  look.set_bearing_deg(30);
  look.set_tilt_deg(-5);
  ASSERT_TRUE(is_ok(hand.set_pose("bow", look, ack)));
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(1, 200, 2), ack)));
  EXPECT_NEAR(std::remainder(info(hand, "bow").pose().bearing_deg() - 230, 360), 0, 1e-9);
  EXPECT_EQ(info(hand, "bow").pose().tilt_deg(), -5);
  EXPECT_EQ(info(hand, "stern").pose().tilt_deg(), 0);
  expect_refused(hand.set_pose("bow", sailed(1, 2, 3), ack), 100, "rides on platform ship");
  expect_refused(host.set_pose("stern", look, ack), 103, "not claimed: settings");

  ASSERT_TRUE(is_ok(host.release_control("ship")));
  EXPECT_EQ(info(hand, "bow").controller(), "");
  EXPECT_EQ(info(hand, "stern").controller(), "");
  expect_refused(host.release_control("ship"), 103, "not claimed: pose");
  EXPECT_NE(info(hand, "bow").settings_controller(), "") << "released only by its own holder";
}

TEST_F(Ship, WhatIsRefusedOfOneRadarMovesNone) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(1, 0, 1'000'000'000), ack)));
  const std::string before = info(hand, "bow").pose().SerializeAsString();
  wire::Pose steep = sailed(1, 0, 1'100'000'000);
  steep.set_pitch_deg(60.5);
  expect_refused(host.set_pose("ship", steep, ack), 100, "pitch_deg: found 60.5");
  wire::Pose nowhere = sailed(1, 0, 1'100'000'000);
  nowhere.set_latitude_deg(90);  // the stern would be over the pole, the bow beyond it
  nowhere.set_height_m(std::numeric_limits<double>::quiet_NaN());
  expect_refused(host.set_pose("ship", nowhere, ack), 100, "height_m");
  EXPECT_EQ(info(hand, "bow").pose().SerializeAsString(), before);
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(3, 0, 500'000'000), ack)));
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_NE(ack.warnings(0).find("the pose is not taken"), std::string::npos) << ack.warnings(0);
  EXPECT_EQ(info(host, "ship").pose().longitude_deg(), 1);
  wire::Pose again = sailed(3, 0, 500'000'000);
  again.set_new_time_line(true);
  again.set_tilt_deg(4);
  ASSERT_TRUE(is_ok(host.set_pose("ship", again, ack)));
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_EQ(ack.warnings(0), "tilt_deg: not taken: each radar of a platform has its own");
  EXPECT_EQ(info(host, "ship").pose().longitude_deg(), 3);
}

TEST_F(Ship, ABearingAloneIsItsHeading) {
  ASSERT_TRUE(is_ok(host.claim_control("ship")));
  wire::Pose old;
  old.set_bearing_deg(45);
  ASSERT_TRUE(is_ok(host.set_pose("ship", old, ack)));
  EXPECT_EQ(info(host, "ship").pose().heading_deg(), 45);
  EXPECT_NEAR(info(host, "bow").pose().bearing_deg(), 45, 1e-9);
}

TEST_F(Ship, AGimbalsLimitIsSaidAndHoldsTheAntennaUntilItLooksBack) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(1, 40, 1'000'000'000), ack)));
  ASSERT_TRUE(is_ok(hand.claim_control("stern")));
  EXPECT_EQ(info(hand, "stern").gimbal(), "");
  wire::Pose look;
  look.set_bearing_deg(180 + 35);  // from the heading: the right edge 65 degrees from where the mount looks
  look.set_tilt_deg(-45);
  ASSERT_TRUE(is_ok(hand.set_pose("stern", look, ack)));
  const std::string limit =
      "azimuth at its limit of 50 deg, 15.0 deg short; elevation at its limit of -30 deg, 15.0 deg short";
  EXPECT_EQ(info(hand, "stern").gimbal(), limit);
  wire::Status status;
  ASSERT_TRUE(is_ok(hand.get_status(status)));
  EXPECT_EQ(status.radars(1).gimbal(), limit);
  EXPECT_EQ(status.radars(0).gimbal(), "");
  server.panel().change(0, {}, std::chrono::seconds(20));  // makes new snapshots
  EXPECT_TRUE(server.panel().status(1)->at_gimbal_limit);
  EXPECT_FALSE(server.panel().status(0)->at_gimbal_limit);

  const auto seen = [&] {
    client::FrameAssembler frames;
    wire::RenderOnce request;
    request.set_radar("stern");
    request.set_as_live(true);
    EXPECT_TRUE(is_ok(hand.render_once(request)));
    EXPECT_TRUE(is_ok(receive_frame(hand, frames)));
    hand.set_handler(nullptr);
    return frames.frame().descriptor->pose();
  };
  EXPECT_NEAR(std::remainder(seen().bearing_deg() - (40 + 200), 360), 0, 1e-9);
  EXPECT_EQ(seen().tilt_deg(), -30);

  // What was asked is kept: with the ship's way back, or a narrower sector, it looks as asked.
  wire::RadarSettings narrow;
  narrow.set_sector_deg(20);
  ASSERT_TRUE(is_ok(hand.set_settings("stern", narrow, ack)));
  EXPECT_EQ(info(hand, "stern").gimbal(), "elevation at its limit of -30 deg, 15.0 deg short");
  EXPECT_NEAR(std::remainder(seen().bearing_deg() - (40 + 215), 360), 0, 1e-9);
  look.set_tilt_deg(-20);
  ASSERT_TRUE(is_ok(hand.set_pose("stern", look, ack)));
  EXPECT_EQ(info(hand, "stern").gimbal(), "");
}

TEST_F(Ship, APoseThatIsLateForOneRadarMovesNone) {
  for (const char* radar : {"bow", "stern"}) ASSERT_TRUE(is_ok(host.claim_control(radar)));
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(1, 0, 5'000'000'000), ack)));
  ASSERT_TRUE(is_ok(host.reset_exercise("bow")));  // it has no clock any more
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(3, 0, 4'000'000'000), ack)));
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_NE(ack.warnings(0).find("the pose is not taken"), std::string::npos) << ack.warnings(0);
  for (const char* radar : {"bow", "stern"}) EXPECT_NEAR(info(hand, radar).pose().longitude_deg(), 1, 0.01);
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(2, 0, 6'000'000'000), ack)));
  for (const char* radar : {"bow", "stern"}) EXPECT_NEAR(info(hand, radar).pose().longitude_deg(), 2, 0.01);
}

TEST_F(Ship, WhatItsPosesSaidOfTimeEndsWithTheirClaim) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  wire::Pose pose = sailed(1, 0, 1'000'000'000);
  pose.set_valid_s(0.5);
  pose.set_time_rate(10);
  ASSERT_TRUE(is_ok(host.set_pose("ship", pose, ack)));
  EXPECT_EQ(info(hand, "ship").pose().time_rate(), 10);
  ASSERT_TRUE(is_ok(host.release_control("ship")));
  EXPECT_EQ(info(hand, "ship").pose().time_rate(), 1);
  EXPECT_EQ(info(hand, "ship").pose().valid_s(), 0);
}

TEST_F(Ship, ItsRadarsPlacesAreJudgedWithIts) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  wire::Pose high = sailed(1, 0, 1'000'000'000);
  high.set_height_m(99'950);
  high.set_pitch_deg(60);  // the bow is 87 m higher
  expect_refused(host.set_pose("ship", high, ack), 100, "radar bow: antenna.height_m: found 100036");
  EXPECT_EQ(info(hand, "ship").pose().longitude_deg(), 0);
}

TEST_F(Ship, BarsAreSettingsThatAClientChanges) {
  ASSERT_TRUE(is_ok(hand.claim_control("bow")));
  wire::RadarSettings settings;
  for (const double tilt_deg : {-2.0, -6.5}) settings.mutable_scan_bars()->add_tilt_deg(tilt_deg);
  ASSERT_TRUE(is_ok(hand.set_settings("bow", settings, ack)));
  const wire::ScanBars found = info(hand, "bow").settings().scan_bars();
  ASSERT_EQ(found.tilt_deg_size(), 2);
  EXPECT_EQ(found.tilt_deg(1), -6.5);
  wire::RadarSettings other;
  other.set_r_max_m(20e3);
  ASSERT_TRUE(is_ok(hand.set_settings("bow", other, ack)));
  EXPECT_EQ(info(hand, "bow").settings().scan_bars().tilt_deg_size(), 2) << "absent: as they are";
  settings.mutable_scan_bars()->add_tilt_deg(90.5);
  expect_refused(hand.set_settings("bow", settings, ack), 100,
                 "scan.bars: found [-2.0, -6.5, 90.5]; allowed: a list");
  settings.mutable_scan_bars()->clear_tilt_deg();
  for (int k = 0; k < 20'000; ++k) settings.mutable_scan_bars()->add_tilt_deg(k + 1.0 / 3);
  expect_refused(hand.set_settings("bow", settings, ack), 100, "scan.bars: found 20000 numbers");
  settings.mutable_scan_bars()->clear_tilt_deg();
  for (int k = 0; k < 17; ++k) settings.mutable_scan_bars()->add_tilt_deg(k);
  expect_refused(hand.set_settings("bow", settings, ack), 100, "a list of up to 16 numbers, -90 to 90 deg");
  settings.mutable_scan_bars()->clear_tilt_deg();
  ASSERT_TRUE(is_ok(hand.set_settings("bow", settings, ack)));
  EXPECT_EQ(info(hand, "bow").settings().scan_bars().tilt_deg_size(), 0) << "an empty list ends them";
}

TEST_F(Ship, StatesAndResetsMoveItAsAWhole) {
  ASSERT_TRUE(is_ok(host.claim("ship", kPoseClaim)));
  for (const char* radar : {"bow", "stern", "free"}) ASSERT_TRUE(is_ok(host.claim_control(radar)));
  const std::string start = info(host, "bow").pose().SerializeAsString();
  ASSERT_TRUE(is_ok(host.set_pose("ship", sailed(2, 30, 1'000'000'000), ack)));
  wire::ExerciseState state;
  ASSERT_TRUE(is_ok(host.get_exercise(state)));
  ASSERT_EQ(state.platforms_size(), 1);
  const std::string there = info(host, "bow").pose().SerializeAsString();
  ASSERT_TRUE(is_ok(host.reset_exercise("")));
  EXPECT_EQ(info(host, "bow").pose().SerializeAsString(), start);
  EXPECT_EQ(info(host, "ship").pose().longitude_deg(), 0);
  ASSERT_TRUE(is_ok(host.load_exercise(state)));
  EXPECT_EQ(info(host, "bow").pose().SerializeAsString(), there);
  EXPECT_EQ(info(host, "ship").pose().longitude_deg(), 2);
  ASSERT_TRUE(is_ok(host.reset_exercise("bow")));
  EXPECT_NEAR(info(host, "bow").pose().longitude_deg(), 2, 0.01) << "it stays on its platform";
  state.mutable_platforms(0)->set_platform("shop");
  expect_refused(host.load_exercise(state), 100, "platforms: found nothing of ship");
}

TEST_F(Ship, TheConsoleTurnsARidersAntennaAndDoesNotMoveIt) {
  net::PanelChange change;
  change.settings.push_back({find_parameter("antenna.tilt_deg"), -7.0});
  EXPECT_EQ(server.panel().change(0, change, std::chrono::seconds(20)).verdict, net::PanelVerdict::done);
  EXPECT_EQ(info(hand, "bow").pose().tilt_deg(), -7);
  change.settings.push_back({find_parameter("antenna.latitude_deg"), 1.0});
  const net::PanelAnswer answer = server.panel().change(0, change, std::chrono::seconds(20));
  EXPECT_EQ(answer.verdict, net::PanelVerdict::invalid);
  ASSERT_EQ(answer.errors.size(), 1u);
  EXPECT_EQ(answer.errors[0].field, "antenna.latitude_deg");
}

}  // namespace
}  // namespace obliq::test::platform_test
