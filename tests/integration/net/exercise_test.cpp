// The exercise: its state saved and put back, radars reset, all of them stopped.
#include "server/net/exercise/exercise.h"

#include <gtest/gtest.h>

#include "proto/obliq.pb.h"
#include "server/net/panel.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::exercise_test {
namespace {

using client::Status;

wire::ExerciseState state_of(client::Client& client) {
  wire::ExerciseState state;
  EXPECT_TRUE(is_ok(client.get_exercise(state)));
  state.clear_request_id();
  return state;
}

/// Moves, sets and switches both radars, to what `k` says.
void disturb(client::Client& client, int k) {
  for (const char* radar : {"main", "nose"}) {
    ASSERT_TRUE(is_ok(client.claim_control(radar)));
    wire::Pose pose;
    pose.set_latitude_deg(0.125 * k);
    pose.set_bearing_deg(10 * k);
    pose.set_sim_time_ns(1'000'000'000LL * k);
    pose.set_tilt_deg(-k);
    wire::RadarSettings settings;
    settings.set_power_w(100 + k);
    settings.set_speckle_seed(k);
    settings.set_noise_seed(-k);
    wire::Ack ack;
    ASSERT_TRUE(is_ok(client.set_pose(radar, pose, ack)));
    ASSERT_TRUE(is_ok(client.set_settings(radar, settings, ack)));
    ASSERT_TRUE(is_ok(client.set_state(radar, k % 2 == 0, k % 3 == 0)));
    ASSERT_TRUE(is_ok(client.release_control(radar)));
  }
}

class ExerciseTest : public Served {
 protected:
  /// Refused with one field that begins so, and nothing has changed.
  void expect_refused(const wire::ExerciseState& state, const std::string& field, const std::string& part) {
    const std::string before = state_of(client).SerializeAsString();
    const Status refused = client.load_exercise(state);
    EXPECT_EQ(refused.number, 100u) << refused.sentence();
    EXPECT_NE(refused.sentence().find(field), std::string::npos) << refused.sentence();
    EXPECT_NE(refused.sentence().find(part), std::string::npos) << refused.sentence();
    EXPECT_EQ(state_of(client).SerializeAsString(), before);
  }
};

TEST_F(ExerciseTest, AStateComesBackAsItWas) {
  disturb(client, 3);
  const wire::ExerciseState saved = state_of(client);
  ASSERT_EQ(saved.radars_size(), 2);
  EXPECT_EQ(saved.radars(0).pose().bearing_deg(), 30);
  EXPECT_EQ(saved.radars(0).pose().sim_time_ns(), 3'000'000'000);
  EXPECT_EQ(saved.radars(1).settings().noise_seed(), -3);
  EXPECT_TRUE(saved.radars(1).transmit_off());
  EXPECT_TRUE(saved.radars(1).frozen());
  disturb(client, 4);
  EXPECT_NE(state_of(client).SerializeAsString(), saved.SerializeAsString());
  ASSERT_TRUE(is_ok(client.load_exercise(saved)));
  EXPECT_EQ(state_of(client).DebugString(), saved.DebugString());
}

TEST_F(ExerciseTest, AStateThatDoesNotFitIsRefusedByFieldAndChangesNothing) {
  disturb(client, 2);
  const wire::ExerciseState good = state_of(client);
  wire::ExerciseState state = good;
  state.set_version(net::kExerciseVersion + 1);
  expect_refused(state, "version: found 2", "allowed: 1 to 1");
  state = good;
  state.set_scene_hash("0123");
  expect_refused(state, "scene_hash: found 0123", "the scene that is served");
  state = good;
  state.mutable_radars()->RemoveLast();
  expect_refused(state, "radars: found nothing of nose", "each radar");
  state = good;
  *state.add_radars() = state.radars(1);
  expect_refused(state, "radars: found 3 radars", "2, each of the server's once");
  state = good;
  state.mutable_radars(1)->set_radar("tail");
  expect_refused(state, "radars: found nothing of nose", "each radar");
  state = good;
  state.mutable_radars(1)->mutable_settings()->set_sector_deg(-4);
  state.mutable_radars(0)->mutable_settings()->set_power_w(1);
  expect_refused(state, "radar nose: radar.sector_deg: found -4", "above 0");
  state = good;
  state.mutable_radars(0)->mutable_pose()->set_height_m(std::nan(""));
  expect_refused(state, "radar main: antenna.height_m: found nan", "-1000 to 100000");
  state = good;
  state.mutable_radars(0)->set_rate_limit_hz(-1);
  expect_refused(state, "radar main: rate_limit_hz", "0 (none)");
  EXPECT_EQ(client.load_exercise({}).number, 100u) << "nothing at all";
}

TEST_F(ExerciseTest, AResetIsTheSceneFilesStateOfOneRadarOrOfAll) {
  const wire::ExerciseState initial = state_of(client);
  disturb(client, 5);
  ASSERT_TRUE(is_ok(client.reset_exercise("nose")));
  wire::ExerciseState now = state_of(client);
  EXPECT_EQ(now.radars(1).DebugString(), initial.radars(1).DebugString());
  EXPECT_EQ(now.radars(0).pose().bearing_deg(), 50);
  ASSERT_TRUE(is_ok(client.reset_exercise("")));
  EXPECT_EQ(state_of(client).DebugString(), initial.DebugString());
  EXPECT_EQ(client.reset_exercise("tail").number, 101u);
}

TEST_F(ExerciseTest, TheConsoleResetsARadarAndStopsAll) {
  const wire::ExerciseState initial = state_of(client);
  disturb(client, 1);
  net::PanelChange change;
  change.reset = true;
  change.exercise_freeze = true;
  EXPECT_EQ(server.panel().change(0, change, std::chrono::seconds(60)).verdict, net::PanelVerdict::done);
  const wire::ExerciseState now = state_of(client);
  EXPECT_EQ(now.radars(0).DebugString(), initial.radars(0).DebugString());
  EXPECT_EQ(now.radars(1).pose().bearing_deg(), 10);
  EXPECT_TRUE(status_of(client).exercise_frozen());
  EXPECT_TRUE(server.panel().status(1)->exercise_frozen);
}

/// Frames of `main` with their bearing, as they come.
struct Watch {
  explicit Watch(const TestServer& server) : client(connect(server, "watcher")) {
    EXPECT_TRUE(is_ok(client.subscribe("main", 100)));
  }
  client::AssembledFrame next() {
    client::FrameAssembler frames;
    EXPECT_TRUE(is_ok(receive_frame(client, frames)));
    return frames.take();
  }
  double next_bearing() { return next().descriptor->pose().bearing_deg(); }
  client::Client client;
};

TEST_F(ExerciseTest, InATotalFreezeAllHaveOneStillAndNothingElseUntilItEnds) {
  ASSERT_TRUE(is_ok(client.claim_control("main")));
  wire::Ack ack;
  wire::Pose pose;
  pose.set_bearing_deg(60);
  ASSERT_TRUE(is_ok(client.set_pose("main", pose, ack)));
  Watch early(server);
  while (early.next_bearing() != 60) {
  }
  ASSERT_TRUE(is_ok(client.freeze_exercise(true)));
  pose.set_bearing_deg(70);
  ASSERT_TRUE(is_ok(client.set_pose("main", pose, ack)));
  wire::RadarSettings settings;
  settings.set_r_max_m(12345);
  ASSERT_TRUE(is_ok(client.set_settings("main", settings, ack)));
  Watch late(server);
  EXPECT_EQ(late.next_bearing(), 60) << "the still, for one who comes";
  // The render thread has begun nothing for the live radar since: other frames it has.
  const std::uint64_t frames = status_of(client).radars(0).frames();
  for (int i = 0; i < 20; ++i) {
    wire::RenderOnce once = once_request();
    ASSERT_TRUE(is_ok(late.client.render_once(once)));
    ASSERT_EQ(late.next().request_id, once.request_id());
  }
  EXPECT_LE(status_of(client).radars(0).frames(), frames + 1) << "the late one's may not have been counted";
  ASSERT_TRUE(is_ok(client.freeze_exercise(false)));
  for (Watch* watch : {&early, &late}) {
    client::AssembledFrame frame = watch->next();
    while (frame.descriptor->pose().bearing_deg() == 60) frame = watch->next();  // what was on its way
    EXPECT_EQ(frame.descriptor->pose().bearing_deg(), 70);
    EXPECT_EQ(frame.descriptor->settings().r_max_m(), 12345);
  }
}

TEST_F(ExerciseTest, AStateThatIsLoadedInATotalFreezeIsShownAsAStill) {
  const wire::ExerciseState initial = state_of(client);
  disturb(client, 2);
  Watch watch(server);
  while (watch.next_bearing() != 20) {
  }
  ASSERT_TRUE(is_ok(client.freeze_exercise(true)));
  ASSERT_TRUE(is_ok(client.load_exercise(initial)));
  while (watch.next_bearing() != 45) {
  }
  EXPECT_TRUE(status_of(client).exercise_frozen());
}

}  // namespace
}  // namespace obliq::test::exercise_test
