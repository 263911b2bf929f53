// Targets by message: how they come, move and go, and what an exercise keeps of them.
#include <chrono>
#include <cmath>
#include <thread>

#include "proto/obliq.pb.h"
#include "tests/integration/net/targets_fixture.h"

namespace obliq::test::target_motion_test {
namespace {

using client::AssembledFrame;
using wire::ErrorNumber;

TEST_F(NetTargets, ComeAndGoAllAtOnce) {
  serve();
  client::Client host = holder();
  wire::SetTargets many;
  for (std::uint64_t id = 1; id <= 10000; ++id) {
    wire::Target& t = *many.add_targets() = target(id, 2000 + static_cast<double>(id) / 2);
    t.set_name("target " + std::to_string(id));
  }
  ASSERT_TRUE(is_ok(set(host, many))) << "in several messages";
  const wire::TargetList list = list_of(host);
  ASSERT_EQ(list.targets_size(), 10000);
  EXPECT_EQ(list.targets(9999).name(), "target 10000");
  EXPECT_EQ(list.version(), 2u) << "one change";
  EXPECT_EQ(render(host, frame_request(true, true)).targets.size(), 10000u);
  wire::SetTargets swap = request_of({target(20000, 5000)});
  swap.set_clear(true);
  ASSERT_TRUE(is_ok(set(host, swap)));
  ASSERT_EQ(list_of(host).targets_size(), 1);
  wire::SetTargets gone;
  gone.add_gone(20000);
  gone.add_gone(1);
  ASSERT_TRUE(is_ok(set(host, gone))) << "one that is not there is gone already";
  EXPECT_EQ(list_of(host).targets_size(), 0);
}

TEST_F(NetTargets, GoWhenTheirValidityIsOver) {
  serve();
  client::Client host = holder();
  wire::Target brief = target(1, 5000);
  brief.set_valid_s(0.2);
  ASSERT_TRUE(is_ok(set(host, {brief, target(2, 6000)})));
  EXPECT_EQ(render(host, frame_request(true, true)).targets.size(), 2u);
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  EXPECT_EQ(render(host, frame_request(true, true)).targets.size(), 1u);
  EXPECT_EQ(status_of(host).targets_expired(), 1u);
  EXPECT_EQ(list_of(host).targets_size(), 1);
}

TEST_F(NetTargets, WithoutASimTimeMoveByTheServersClockAndStandInATotalFreeze) {
  serve();
  client::Client host = holder();
  wire::Target mover = target(1, 3000);
  mover.clear_sim_time_ns();
  mover.set_velocity_north_m_s(1000);
  ASSERT_TRUE(is_ok(set(host, {mover})));
  const auto range_of = [&] {
    wire::RenderOnce request = frame_request(true, true);
    request.mutable_pose()->clear_sim_time_ns();
    const AssembledFrame frame = render(host, request);
    return frame.targets.size() == 1 ? frame.targets[0].range_m : -1;
  };
  const double first = range_of();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const double second = range_of();
  EXPECT_GT(second, first + 80);
  ASSERT_TRUE(is_ok(host.claim_control("main")));
  ASSERT_TRUE(is_ok(host.freeze_exercise(true)));
  const double frozen = range_of();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(range_of(), frozen);
  ASSERT_TRUE(is_ok(host.freeze_exercise(false)));
  EXPECT_LT(range_of(), frozen + 90) << "the pause is no time";
}

TEST_F(NetTargets, ChangeFromWhereTheyHaveCome) {
  serve();
  client::Client host = holder();
  wire::Target mover = target(1, 3000);
  mover.set_velocity_north_m_s(100);
  ASSERT_TRUE(is_ok(set(host, {mover})));
  wire::Target stop;
  stop.set_id(1);
  stop.set_sim_time_ns(10'000'000'000);
  stop.set_velocity_north_m_s(0);
  ASSERT_TRUE(is_ok(set(host, {stop})));
  EXPECT_NEAR(render(host, frame_request(true, true, 20'000'000'000)).targets[0].range_m,
              std::hypot(4000, 1000), 0.5);
  // What says nothing of place or motion leaves both.
  wire::Target renamed;
  renamed.set_id(1);
  renamed.set_name("Öl 1");
  ASSERT_TRUE(is_ok(set(host, {renamed})));
  const wire::Target now = list_of(host).targets(0);
  EXPECT_EQ(now.name(), "Öl 1");
  EXPECT_EQ(now.sim_time_ns(), 10'000'000'000);
}

TEST_F(NetTargets, AreSavedLoadedResetAndLogged) {
  TargetConfig of_file;
  of_file.name = "of the file";
  of_file.target = scene_.at(0, 4000, 0);
  options_.targets = {of_file};
  serve();
  client::Client host = holder();
  ASSERT_TRUE(is_ok(host.claim_control("main")));
  wire::Target round = target(2, 5000);
  for (const double east : {1000.0, 2000.0}) {
    const Target at = scene_.at(east, 5000, 0);
    round.mutable_route()->add_latitude_deg(at.latitude_deg);
    round.mutable_route()->add_longitude_deg(at.longitude_deg);
    round.mutable_route()->add_height_m(0);
    round.mutable_route()->add_speed_m_s(50);
  }
  round.mutable_route()->set_loops(true);
  ASSERT_TRUE(is_ok(set(host, {round})));
  wire::ExerciseState saved;
  ASSERT_TRUE(is_ok(host.get_exercise(saved)));
  ASSERT_EQ(saved.targets_size(), 2);
  EXPECT_TRUE(saved.with_targets());
  ASSERT_TRUE(is_ok(host.reset_exercise("")));
  EXPECT_EQ(list_of(host).targets_size(), 1);
  ASSERT_TRUE(is_ok(host.load_exercise(saved)));
  const wire::TargetList loaded = list_of(host);
  ASSERT_EQ(loaded.targets_size(), 2);
  EXPECT_EQ(loaded.targets(1).SerializeAsString(), saved.targets(1).SerializeAsString());
  // 60 s on: 1 km east by 20 s, 2 km by 40 s, then back.
  EXPECT_NEAR(render(host, frame_request(true, true, 60'000'000'000)).targets[1].bearing_deg,
              std::atan2(1000, 5000) / kDegree_rad, 0.02);
  wire::ExerciseState spoilt = saved;
  spoilt.mutable_targets(0)->set_swerling(7);
  EXPECT_EQ(host.load_exercise(spoilt).number, number(ErrorNumber::invalid_value));
  wire::ExerciseEvents events;
  ASSERT_TRUE(is_ok(host.get_events(0, false, events)));
  int come = 0, claims = 0;
  for (const wire::ExerciseEvent& event : events.events()) {
    EXPECT_EQ(event.state().targets_size(), 0);
    if (event.kind() == wire::TARGETS_EVENT) come += static_cast<int>(event.targets_come());
    claims += event.kind() == wire::CLAIM_EVENT && event.claims(0) == wire::TARGETS_CLAIM;
  }
  EXPECT_EQ(come, 1);
  EXPECT_EQ(claims, 1);
}

TEST_F(NetTargets, OfMoreThanOneMessageHoldsAreSavedAndLoaded) {
  serve();
  client::Client host = holder();
  ASSERT_TRUE(is_ok(host.claim_control("main")));
  std::vector<wire::Target> many;
  for (std::uint64_t id = 1; id <= 10'000; ++id) {
    many.push_back(target(id, 3000 + 0.5 * static_cast<double>(id)));
    many.back().set_name("a target with quite a long name " + std::to_string(id));
    many.back().set_sim_time_ns(1'000'000'000);
  }
  ASSERT_TRUE(is_ok(set(host, many)));
  wire::ExerciseState saved;
  ASSERT_TRUE(is_ok(host.get_exercise(saved)));
  ASSERT_EQ(saved.targets_size(), 10'000);
  ASSERT_TRUE(is_ok(host.reset_exercise("")));
  ASSERT_TRUE(is_ok(host.release_targets()));
  EXPECT_EQ(list_of(host).targets_size(), 0);
  ASSERT_TRUE(is_ok(host.load_exercise(saved)));
  const wire::TargetList loaded = list_of(host);
  ASSERT_EQ(loaded.targets_size(), 10'000);
  for (const int k : {0, 4567, 9999})
    EXPECT_EQ(loaded.targets(k).SerializeAsString(), saved.targets(k).SerializeAsString());
  // A state of another scene changes neither.
  wire::ExerciseState other = saved;
  other.set_scene_hash("another");
  other.mutable_targets()->DeleteSubrange(0, 3);
  EXPECT_EQ(host.load_exercise(other).number, number(ErrorNumber::invalid_value));
  EXPECT_EQ(list_of(host).targets_size(), 10'000);
}

TEST_F(NetTargets, GoOnAlongTheirRouteWhateverElseIsSaid) {
  serve();
  client::Client host = holder();
  wire::Target mover = target(1, 3000);
  for (const double north : {5000.0, 8000.0}) {
    const Target at = scene_.at(0, north, 0);
    mover.mutable_route()->add_latitude_deg(at.latitude_deg);
    mover.mutable_route()->add_longitude_deg(at.longitude_deg);
    mover.mutable_route()->add_speed_m_s(100);
  }
  ASSERT_TRUE(is_ok(set(host, {mover})));
  wire::Target word;
  word.set_id(1);
  word.set_rcs_dbsm(3);
  word.set_sim_time_ns(30'000'000'000);
  word.set_valid_s(1000);
  ASSERT_TRUE(is_ok(set(host, {word})));
  EXPECT_NEAR(render(host, frame_request(true, true, 31'000'000'000)).targets[0].range_m,
              std::hypot(6100, 1000), 2);
  EXPECT_NEAR(render(host, frame_request(true, true, 90'000'000'000)).targets[0].range_m,
              std::hypot(8000, 1000), 2);
}

TEST_F(NetTargets, AreRefusedInAMessageThatFitsHoweverMuchIsWrong) {
  serve();
  client::Client host = holder();
  wire::SetTargets gone;
  for (int k = 0; k < 20000; ++k) gone.add_gone(5);
  EXPECT_EQ(set(host, gone).number, number(ErrorNumber::invalid_value));
  wire::Target wrong = target(1, 3000);
  for (int k = 0; k < 1000; ++k) {
    wrong.mutable_route()->add_latitude_deg(std::nan(""));
    wrong.mutable_route()->add_longitude_deg(std::nan(""));
    wrong.mutable_route()->add_height_m(std::nan(""));
    wrong.mutable_route()->add_speed_m_s(std::nan(""));
  }
  EXPECT_EQ(set(host, {wrong}).number, number(ErrorNumber::invalid_value));
  // However far it has come, it can be stopped there.
  wire::Target climber = target(2, 3000);
  climber.set_velocity_up_m_s(1000);
  ASSERT_TRUE(is_ok(set(host, {climber})));
  wire::Target stop;
  stop.set_id(2);
  stop.set_sim_time_ns(2'000'000'000'000);
  stop.set_velocity_up_m_s(0);
  EXPECT_TRUE(is_ok(set(host, {stop})));
}

TEST_F(NetTargets, OfManyEmptyOnesAreRefusedBeforeTheyTakeMemory) {
  serve();
  client::Client host = holder();
  wire::SetTargets many;
  many.set_more(true);
  for (int k = 0; k < 10001; ++k) many.add_targets();
  EXPECT_EQ(set(host, many).number, number(ErrorNumber::over_limit));
}

TEST_F(NetTargets, OfARequestThatEndsInItsMiddleAreForgotten) {
  serve();
  client::Client host = holder();
  ASSERT_TRUE(is_ok(set(host, {target(1, 5000)})));
  wire::SetTargets part = request_of({target(2, 6000)});
  part.set_more(true);
  part.set_clear(true);
  client::Client other = connect("", "other");
  ASSERT_TRUE(is_ok(set(host, part)));  // the client ends it itself
  EXPECT_EQ(list_of(host).targets_size(), 1);
}

}  // namespace
}  // namespace obliq::test::target_motion_test
