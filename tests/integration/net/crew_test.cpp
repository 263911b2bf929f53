// One client flies a radar, another operates it: what becomes of where the antenna looks, in poses and
// frames; and the operator's console beside them.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/net/panel.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::crew_test {
namespace {

using client::Status;
using wire::kPoseClaim;
using wire::kSettingsClaim;

wire::Pose turned(double bearing_deg) {
  wire::Pose pose;
  pose.set_bearing_deg(bearing_deg);
  return pose;
}

wire::Pose headed(double heading_deg) {
  wire::Pose pose;
  pose.set_heading_deg(heading_deg);
  return pose;
}

/// The Ack of a SetPose that must be taken.
wire::Ack set_pose(client::Client& client, const wire::Pose& pose) {
  wire::Ack ack;
  EXPECT_TRUE(is_ok(client.set_pose("main", pose, ack)));
  return ack;
}

/// One flies, another operates.
class Crew : public testing::Test {
 protected:
  Crew() {
    EXPECT_TRUE(is_ok(host.claim("main", kPoseClaim)));
    EXPECT_TRUE(is_ok(hand.claim("main", kSettingsClaim)));
  }
  const TestServer server;
  client::Client host = connect(server, "host");
  client::Client hand = connect(server, "hand");
};

TEST_F(Crew, TiltIsTheOperatorsAndTheFlyersIsNotTakenWithAWarning) {
  set_pose(hand, tilted(-7));
  wire::Pose pose = moved();
  pose.set_tilt_deg(2);
  pose.set_tilt_auto(true);
  const wire::Ack ack = set_pose(host, pose);
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_EQ(ack.warnings(0).rfind("tilt_deg, tilt_auto: not taken: hand", 0), 0u) << ack.warnings(0);
  const wire::Pose now = info_of(host).pose();
  EXPECT_EQ(now.tilt_deg(), -7);
  EXPECT_FALSE(now.tilt_auto());
  EXPECT_EQ(now.latitude_deg(), 0.5);
}

TEST_F(Crew, TheSectorsCentreCountsFromTheHeading) {
  set_pose(host, headed(100));
  set_pose(hand, turned(30));
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 130);
  EXPECT_EQ(set_pose(host, headed(110)).warnings_size(), 0);
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 140);
  wire::Pose both = headed(120);
  both.set_bearing_deg(5);
  const wire::Ack ack = set_pose(host, both);
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_EQ(ack.warnings(0).rfind("bearing_deg: not taken: hand", 0), 0u) << ack.warnings(0);
  const wire::Pose now = info_of(hand).pose();
  EXPECT_EQ(now.bearing_deg(), 150);
  EXPECT_EQ(now.heading_deg(), 120);
  // Round the north it stays within what a bearing may be.
  set_pose(host, headed(350));
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 20);
}

TEST_F(Crew, TheBearingOfAFlyerThatNamesNoHeadingIsTheHeading) {
  const wire::Ack ack = set_pose(host, turned(40));
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_EQ(ack.warnings(0).rfind("bearing_deg: taken for the heading: hand", 0), 0u) << ack.warnings(0);
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 40);
  set_pose(hand, turned(-15));
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 25);
  set_pose(host, turned(50));
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 35);
}

TEST_F(Crew, WhereTheAntennaLooksStaysWhenTheOperatorHasGone) {
  set_pose(host, headed(100));
  set_pose(hand, turned(30));
  set_pose(hand, tilted(-4));
  EXPECT_TRUE(is_ok(hand.release_control("main")));
  EXPECT_EQ(set_pose(host, headed(200)).warnings_size(), 0);
  const wire::Pose now = info_of(host).pose();
  EXPECT_EQ(now.bearing_deg(), 230);
  EXPECT_EQ(now.tilt_deg(), -4);
  // And the flyer alone has all of it again.
  wire::Pose all = headed(10);
  all.set_bearing_deg(350);
  all.set_tilt_deg(1);
  EXPECT_EQ(set_pose(host, all).warnings_size(), 0);
  EXPECT_EQ(info_of(host).pose().bearing_deg(), 350);
  EXPECT_EQ(info_of(host).pose().tilt_deg(), 1);
}

TEST_F(Crew, APoseWithMoreThanWhereTheAntennaLooksIsTheFlyersAlone) {
  wire::Pose pose = tilted(-5);
  pose.set_height_m(200);
  wire::Ack ack;
  const Status refused = hand.set_pose("main", pose, ack);
  EXPECT_EQ(refused.number, 102u);
  EXPECT_NE(refused.text.find("pose is held by host"), std::string::npos) << refused.text;
  EXPECT_EQ(hand.set_pose("main", {}, ack).number, 102u) << "an empty pose is a pose as before";
  EXPECT_NE(info_of(hand).pose().tilt_deg(), -5);
}

TEST_F(Crew, NumbersOutOfLimitsAreNamedOnBothSides) {
  wire::Ack ack;
  for (client::Client* client : {&host, &hand}) {
    const Status refused = client->set_pose("main", turned(400), ack);
    EXPECT_EQ(refused.number, 100u) << refused.sentence();
    EXPECT_NE(refused.sentence().find("antenna.bearing_deg"), std::string::npos) << refused.sentence();
  }
  EXPECT_EQ(host.set_pose("main", headed(std::nan("")), ack).number, 100u);
}

TEST(OneFliesOneOperates, AnOperatorAloneTurnsTheAntennaByTrueBearings) {
  const TestServer server;
  client::Client hand = connect(server, "hand");
  ASSERT_TRUE(is_ok(hand.claim("main", kSettingsClaim)));
  set_pose(hand, turned(77));
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 77);
  set_pose(hand, tilted(-2));
  EXPECT_EQ(info_of(hand).pose().bearing_deg(), 77);
  EXPECT_EQ(info_of(hand).pose().tilt_deg(), -2);
}

TEST(OneFliesOneOperates, FramesHaveTheOperatorsTurnAlsoWhileTheFlyersClockStands) {
  const TestServer server;
  client::Client host = connect(server, "host");
  client::Client hand = connect(server, "hand");
  ASSERT_TRUE(is_ok(host.claim("main", kPoseClaim)));
  ASSERT_TRUE(is_ok(hand.claim("main", kSettingsClaim)));
  for (int i = 0; i < 3; ++i) {
    wire::Pose pose = headed(60 + i);
    pose.set_sim_time_ns(1'000'000'000 + i * 20'000'000);
    set_pose(host, pose);
  }
  set_pose(hand, turned(20));
  client::Client watcher = connect(server, "watcher");
  ASSERT_TRUE(is_ok(watcher.subscribe("main", 50)));
  wire::Pose shown;
  while (shown.bearing_deg() != 82) {
    client::FrameAssembler frames;
    ASSERT_TRUE(is_ok(receive_frame(watcher, frames)));
    expect_pattern(frames.frame());
    shown = frames.frame().descriptor->pose();
  }
  EXPECT_EQ(shown.sim_time_ns(), 1'040'000'000);
}

/// The operator's console beside clients.
net::PanelAnswer console(TestServer& server, const std::string& key, Value value) {
  net::PanelChange change;
  change.settings.push_back({find_parameter(key), std::move(value)});
  return server.panel().change(0, std::move(change), std::chrono::seconds(60));
}

TEST(OneFliesOneOperates, TheConsoleHasWhatNoClientHolds) {
  TestServer server;
  client::Client host = connect(server, "host");
  ASSERT_TRUE(is_ok(host.claim("main", kPoseClaim)));
  set_pose(host, headed(100));
  using enum net::PanelVerdict;
  EXPECT_EQ(console(server, "radar.power_w", 5.0).verdict, done);
  EXPECT_EQ(console(server, "antenna.tilt_deg", -6.0).verdict, done);
  EXPECT_EQ(console(server, "antenna.bearing_deg", 25.0).verdict, done) << "from the heading";
  const net::PanelAnswer refused = console(server, "antenna.latitude_deg", 1.0);
  EXPECT_EQ(refused.verdict, controlled);
  EXPECT_EQ(refused.held.rfind("pose is held by host", 0), 0u) << refused.held;
  wire::RadarInfo info = info_of(host);
  EXPECT_EQ(info.settings().power_w(), 5);
  EXPECT_EQ(info.pose().tilt_deg(), -6);
  EXPECT_EQ(info.pose().bearing_deg(), 125);
  set_pose(host, headed(110));
  EXPECT_EQ(info_of(host).pose().bearing_deg(), 135);

  ASSERT_TRUE(is_ok(host.release_control("main")));
  ASSERT_TRUE(is_ok(host.claim("main", kSettingsClaim)));
  for (const auto& [key, value] :
       {std::pair{"radar.power_w", 6.0}, {"antenna.tilt_deg", 1.0}, {"antenna.bearing_deg", 1.0}}) {
    const net::PanelAnswer held = console(server, key, value);
    EXPECT_EQ(held.verdict, controlled) << key;
    EXPECT_EQ(held.held.rfind("settings are held by host", 0), 0u) << held.held;
  }
  EXPECT_EQ(console(server, "antenna.latitude_deg", 1.0).verdict, done);
  EXPECT_EQ(info_of(host).pose().latitude_deg(), 1);
}

/// Waits until the newest pose has aged to that.
void await_stale(client::Client& client) {
  while (!info_of(client).pose_stale()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST_F(Crew, AValidityEndsWithWhoeverSaidItByReleaseByLeavingAndByATakeOver) {
  client::Client other = connect(server, "other");
  wire::Pose brief = moved();
  brief.set_valid_s(0.02);
  for (const char* how : {"release", "leaving", "take-over"}) {
    SCOPED_TRACE(how);
    client::Client flyer = connect(server, "flyer");
    ASSERT_TRUE(is_ok(flyer.claim("main", kPoseClaim, true)));
    set_pose(flyer, brief);
    await_stale(other);
    if (how == std::string("release")) {
      ASSERT_TRUE(is_ok(flyer.release("main", kPoseClaim)));
    } else if (how == std::string("leaving")) {
      flyer.close();
      while (!info_of(other).controller().empty()) std::this_thread::yield();
    } else {
      ASSERT_TRUE(is_ok(other.claim("main", kPoseClaim, true)));
    }
    EXPECT_FALSE(info_of(other).pose_stale());
    EXPECT_EQ(info_of(other).pose().valid_s(), 0);
    EXPECT_EQ(info_of(other).pose().latitude_deg(), 0.5) << "the radar stays where it was";
  }
}

}  // namespace
}  // namespace obliq::test::crew_test
