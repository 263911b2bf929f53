// Velocity and attitude of a pose on their way from a client to frames, and what is refused of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/net/panel.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::motion_test {
namespace {

wire::Pose at_latitude(double latitude_deg) {
  wire::Pose pose;
  pose.set_latitude_deg(latitude_deg);
  return pose;
}

/// The equator's radius (WGS84) and 1 km, the height of small_radar.
constexpr double kNorthward_m = 6335439.327 + 1000;  // radius of the meridian there, a (1 - e^2)

wire::Pose flown(int step) {
  // 20 ms and 4 m to the north each: 200 m/s.
  wire::Pose pose = at_latitude(4.0 * step / kNorthward_m * 180 / M_PI);
  pose.set_sim_time_ns(1'000'000'000 + step * 20'000'000);
  return pose;
}

class Motion : public Served {
 protected:
  Motion() { EXPECT_TRUE(is_ok(client.claim("main", wire::kEveryClaim))); }
  void set(const wire::Pose& pose) {
    wire::Ack ack;
    ASSERT_TRUE(is_ok(client.set_pose("main", pose, ack)));
  }
  wire::Pose newest() {
    wire::RadarInfo info;
    EXPECT_TRUE(is_ok(client.get_radar("main", info)));
    return info.pose();
  }
  /// Of a frame of this moment.
  wire::Pose shown() {
    wire::RenderOnce request;
    request.set_radar("main");
    request.set_as_live(true);
    EXPECT_TRUE(is_ok(client.render_once(request)));
    client::FrameAssembler frames;
    EXPECT_TRUE(is_ok(receive_frame(client, frames)));
    return frames.frame().descriptor->pose();
  }
};

TEST_F(Motion, FramesHaveTheVelocityOfThePosesByTheirOwnSimTimes) {
  EXPECT_FALSE(shown().has_velocity_north_m_s());
  for (int i = 0; i < 3; ++i) set(flown(i));
  EXPECT_FALSE(newest().has_velocity_north_m_s()) << "as it was sent";
  client::Client watcher = connect(server, "watcher");
  ASSERT_TRUE(is_ok(watcher.subscribe("main", 50)));
  client::FrameAssembler frames;
  ASSERT_TRUE(is_ok(receive_frame(watcher, frames)));
  for (const wire::Pose& pose : {shown(), frames.frame().descriptor->pose()}) {
    EXPECT_NEAR(pose.velocity_north_m_s(), 200, 0.01);
    EXPECT_NEAR(pose.velocity_east_m_s(), 0, 1e-6);
    EXPECT_NEAR(pose.velocity_up_m_s(), 0, 0.01);
    EXPECT_TRUE(pose.has_velocity_up_m_s()) << "all three, where there is one";
  }
  wire::Pose anew = flown(3);
  anew.set_new_time_line(true);
  set(anew);
  EXPECT_FALSE(shown().has_velocity_north_m_s()) << "across a new time line none";
}

TEST_F(Motion, AGivenVelocityHoldsUntilAPlaceOrATimeComesWithoutOne) {
  wire::Pose pose = at_latitude(0.25);
  pose.set_velocity_east_m_s(-75);
  set(pose);
  EXPECT_EQ(newest().velocity_east_m_s(), -75);
  EXPECT_EQ(newest().velocity_north_m_s(), 0);
  EXPECT_TRUE(newest().has_velocity_north_m_s());
  EXPECT_EQ(shown().velocity_east_m_s(), -75);
  wire::Pose tilt;
  tilt.set_tilt_deg(-3);
  set(tilt);
  EXPECT_EQ(newest().velocity_east_m_s(), -75) << "the antenna is turned, and goes on";
  wire::Pose part;
  part.set_velocity_up_m_s(5);
  set(part);
  EXPECT_EQ(newest().velocity_east_m_s(), -75);
  EXPECT_EQ(newest().velocity_up_m_s(), 5);
  set(at_latitude(0.3));
  EXPECT_FALSE(newest().has_velocity_east_m_s());
  EXPECT_FALSE(shown().has_velocity_up_m_s());
}

TEST_F(Motion, RollAndPitchStayUntilOthersComeAndStandInFrames) {
  wire::Pose pose = at_latitude(0.25);
  pose.set_roll_deg(-60);
  pose.set_pitch_deg(12.5);
  set(pose);
  set(at_latitude(0.26));
  EXPECT_EQ(shown().roll_deg(), -60);
  EXPECT_EQ(shown().pitch_deg(), 12.5);
}

TEST_F(Motion, WhatIsNoneIsRefusedByNameAndChangesNothing) {
  struct Case {
    void (wire::Pose::*set)(double);
    double value;
    const char* told;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const Case& c :
       {Case{&wire::Pose::set_velocity_north_m_s, kNaN, "antenna.velocity_north_m_s: found nan; allowed: "},
        Case{&wire::Pose::set_velocity_east_m_s, 20000.5,
             "antenna.velocity_east_m_s: found 20000.5; allowed: \"auto\" or a number -20000 to 20000 m/s"},
        Case{&wire::Pose::set_velocity_up_m_s, -HUGE_VAL, "antenna.velocity_up_m_s: found -inf"},
        Case{&wire::Pose::set_roll_deg, 60.001,
             "antenna.roll_deg: found 60.001; allowed: number -60 to 60 deg"},
        Case{&wire::Pose::set_roll_deg, kNaN, "antenna.roll_deg: found nan"},
        Case{&wire::Pose::set_pitch_deg, -61,
             "antenna.pitch_deg: found -61.0; allowed: number -60 to 60 deg"},
        Case{&wire::Pose::set_pitch_deg, HUGE_VAL, "antenna.pitch_deg: found inf"}}) {
    const wire::Pose before = newest();
    wire::Pose pose = at_latitude(0.4);
    (pose.*c.set)(c.value);
    wire::Ack ack;
    const client::Status refused = client.set_pose("main", pose, ack);
    EXPECT_EQ(refused.number, number(wire::ErrorNumber::invalid_value));
    EXPECT_NE(refused.sentence().find(c.told), std::string::npos) << refused.sentence();
    EXPECT_EQ(newest().SerializeAsString(), before.SerializeAsString());
  }
}

TEST(MotionOfTheConsole, AVelocityIsSetAndEndsWithAPlace) {
  TestServer server;
  client::Client client = connect(server);
  const auto change = [&](const std::string& key, Value value) {
    net::PanelChange wanted;
    wanted.settings.push_back({find_parameter(key), std::move(value)});
    return server.panel().change(0, std::move(wanted), std::chrono::seconds(60)).verdict;
  };
  const auto pose = [&] {
    wire::RadarInfo info;
    EXPECT_TRUE(is_ok(client.get_radar("main", info)));
    return info.pose();
  };
  EXPECT_EQ(change("antenna.velocity_north_m_s", 30.0), net::PanelVerdict::done);
  EXPECT_EQ(change("antenna.roll_deg", 61.0), net::PanelVerdict::invalid);
  EXPECT_EQ(change("antenna.roll_deg", 6.0), net::PanelVerdict::done);
  EXPECT_EQ(pose().velocity_north_m_s(), 30);
  EXPECT_EQ(pose().roll_deg(), 6);
  EXPECT_EQ(change("antenna.height_m", 500.0), net::PanelVerdict::done);
  EXPECT_FALSE(pose().has_velocity_north_m_s());
}

}  // namespace
}  // namespace obliq::test::motion_test
