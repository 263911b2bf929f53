// Targets by message: who may set them, what is refused, what frames and their truth show.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <thread>

#include "proto/obliq.pb.h"
#include "tests/integration/net/targets_fixture.h"

namespace obliq::test::targets_test {
namespace {

using client::AssembledFrame;
using client::Status;
using wire::ErrorNumber;
using wire::HiddenBy;
using wire::TargetRecord;

std::size_t strongest(const std::vector<double>& with, const std::vector<double>& without) {
  std::size_t best = 0;
  for (std::size_t k = 0; k < with.size(); ++k)
    if (with[k] - without[k] > with[best] - without[best]) best = k;
  return best;
}

TEST_F(NetTargets, StandInTheBinsThatTheirTruthNames) {
  serve();
  client::Client host = holder();
  wire::Target mover = target(7, 5000, 800);
  mover.set_velocity_north_m_s(-100);
  ASSERT_TRUE(is_ok(set(host, {mover, target(9, -5000)})));
  const AssembledFrame bare = render(host, frame_request(false, false));
  for (const std::int64_t sim_s : {0, 10}) {
    const AssembledFrame frame = render(host, frame_request(true, true, sim_s * 1'000'000'000));
    EXPECT_EQ(frame.descriptor->targets(), 2u);
    ASSERT_EQ(frame.targets.size(), 2u);
    const TargetRecord& record = frame.targets[0];
    EXPECT_EQ(record.id, 7u);
    const double north_m = 5000 - 100.0 * static_cast<double>(sim_s), d = std::hypot(north_m, 800);
    EXPECT_NEAR(record.range_m, std::hypot(d, kAntenna_m), 1);
    EXPECT_NEAR(record.bearing_deg, std::atan2(800, north_m) / kDegree_rad, 0.01);
    EXPECT_NEAR(record.elevation_deg, -std::atan2(kAntenna_m, d) / kDegree_rad, 0.05);
    EXPECT_NEAR(record.closing_m_s, 100 * north_m / record.range_m, 0.05);
    EXPECT_NEAR(record.rcs_dbsm, 30, 1e-4);
    EXPECT_EQ(record.share_seen, 1);
    EXPECT_EQ(record.hidden_by, HiddenBy::nothing);
    const std::size_t bin = strongest(frame.power_w, bare.power_w);
    EXPECT_EQ(bin / 200, static_cast<std::size_t>(record.azimuth_bin));
    EXPECT_EQ(bin % 200, static_cast<std::size_t>(record.range_bin));
    // The radar equation by hand: 10 GHz of 1 kW, 30 dB.
    const double lambda = 299792458.0 / (radar_.settings.frequency_ghz * 1e9);
    const double power_w = 1000 * lambda * lambda * 1e6 * 1000 /
                           (std::pow(4 * std::numbers::pi, 3) * std::pow(record.range_m, 4));
    EXPECT_NEAR(record.snr_db, 10 * std::log10(power_w / frame.descriptor->noise_power_w()), 0.01);
    EXPECT_FALSE(record.is_power);
    EXPECT_EQ(frame.targets[1].azimuth_bin, -1) << "behind the antenna";
  }
}

TEST_F(NetTargets, OfOneRenderStandBesideTheWorldsOwn) {
  serve();
  client::Client host = holder();
  ASSERT_TRUE(is_ok(set(host, {target(1, 5000), target(2, 6000)})));
  client::Client other = connect();
  wire::RenderOnce own = frame_request(false, true);
  *own.add_targets() = target(2, 7000);
  EXPECT_EQ(render(other, own).targets.size(), 1u);
  own.set_live_targets(true);
  const AssembledFrame both = render(other, own);
  ASSERT_EQ(both.targets.size(), 2u);
  EXPECT_NEAR(both.targets[1].range_m, std::hypot(7000, 1000), 1);
  EXPECT_EQ(list_of(host).targets_size(), 2) << "the world is as it was";
  // The same bits for every client.
  EXPECT_EQ(render(host, own).power_w, both.power_w);
}

TEST_F(NetTargets, AreSetByWhoHoldsTheirClaim) {
  with_tokens();
  serve();
  client::Client viewer = connect(kViewer), host = connect(kController), admin = connect(kAdmin, "admin");
  const std::vector<wire::Target> one{target(1, 5000)};
  EXPECT_EQ(viewer.claim_targets().number, number(ErrorNumber::role_too_low));
  EXPECT_EQ(set(viewer, one).number, number(ErrorNumber::role_too_low));
  EXPECT_EQ(set(host, one).number, number(ErrorNumber::not_in_control));
  ASSERT_TRUE(is_ok(host.claim_targets()));
  ASSERT_TRUE(is_ok(set(host, one)));
  EXPECT_EQ(set(admin, one).number, number(ErrorNumber::controlled_by_other));
  EXPECT_EQ(admin.claim_targets().number, number(ErrorNumber::controlled_by_other));
  EXPECT_EQ(status_of(admin).targets_controller(), host.welcome().client_name());
  EXPECT_EQ(status_of(viewer).targets(), 1u);
  ASSERT_TRUE(is_ok(admin.claim_targets(true)));
  EXPECT_EQ(host.receive(kLong).number, number(ErrorNumber::controlled_by_other)) << "it is told";
  EXPECT_EQ(set(host, one).number, number(ErrorNumber::controlled_by_other));
  EXPECT_EQ(host.release_targets().number, number(ErrorNumber::controlled_by_other));
  ASSERT_TRUE(is_ok(admin.release_targets()));
  ASSERT_TRUE(is_ok(host.claim_targets()));
  EXPECT_TRUE(is_ok(host.claim_targets())) << "again";
  // Who leaves lets the claim go, and leaves the targets.
  host.close();
  while (!status_of(admin).targets_controller().empty()) std::this_thread::yield();
  EXPECT_EQ(list_of(admin).targets_size(), 1);
  EXPECT_EQ(host.claim("main", wire::kTargetsClaim).ok(), false);
}

TEST_F(NetTargets, AreToldToNobodyBelowTheTruthRole) {
  with_tokens();
  serve();
  client::Client host = holder(kController), viewer = connect(kViewer);
  ASSERT_TRUE(is_ok(set(host, {target(1, 5000)})));
  EXPECT_TRUE(host.welcome().truth());
  EXPECT_FALSE(viewer.welcome().truth());
  const auto refused = number(ErrorNumber::role_too_low);
  wire::TargetList list;
  EXPECT_EQ(viewer.get_targets(list).number, refused);
  wire::RenderOnce live = frame_request(true, true);
  EXPECT_EQ(viewer.render_once(live).number, refused);
  wire::Subscribe watch;
  watch.set_radar("main");
  watch.set_rate_hz(10);
  watch.set_truth(true);
  EXPECT_EQ(viewer.subscribe(watch).number, refused);
  watch.set_truth(false);
  watch.add_planes(wire::TARGET);
  EXPECT_EQ(viewer.subscribe(watch).number, refused);
  watch.clear_planes();
  live.set_truth(false);
  live.add_planes(wire::TARGET);
  EXPECT_EQ(viewer.render_once(live).number, refused);
  // The bins show the target to all; the blocks beside them only to clients that asked and may.
  EXPECT_TRUE(render(viewer, frame_request(true, false)).targets.empty());
  watch.set_truth(false);
  watch.add_planes(wire::POWER);
  client::FrameAssembler seen(wire::plane_bit(wire::Plane::power));
  viewer.set_handler(&seen);
  wire::Subscribe with_truth = watch;
  with_truth.set_truth(true);
  ASSERT_TRUE(is_ok(host.subscribe(with_truth)));
  ASSERT_TRUE(is_ok(viewer.subscribe(watch)));
  int blocks = 0;
  viewer.set_tap([&](const client::Message& message) {
    blocks += message.header.type == wire::MessageType::target_block;
    return Status();
  });
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(is_ok(receive_frame(viewer, seen)));
    EXPECT_TRUE(seen.take().targets.empty());
  }
  EXPECT_EQ(blocks, 0);
  wire::ExerciseState state;
  ASSERT_TRUE(is_ok(viewer.get_exercise(state)));
  EXPECT_EQ(state.targets_size(), 0);
  EXPECT_FALSE(state.with_targets());
  wire::ExerciseEvents events;
  ASSERT_TRUE(is_ok(viewer.get_events(0, false, events, true)));
  EXPECT_EQ(events.state().targets_size(), 0);
  EXPECT_EQ(events.SerializeAsString().find("33.0"), std::string::npos);
}

TEST_F(NetTargets, WithMistakesChangeNothing) {
  options_.max_targets = 3;
  options_.target_types = {{.name = "truck", .size = {.rcs_dbsm = 15, .swerling = 1, .length_m = 8}}};
  serve();
  client::Client host = holder();
  ASSERT_TRUE(is_ok(set(host, {target(1, 5000), target(2, 6000)})));
  const std::string before = list_of(host).SerializeAsString();
  const auto expect_refused = [&](const std::string& field, const std::function<void(wire::Target&)>& spoil) {
    wire::Target wrong = target(1, 5500);
    spoil(wrong);
    const Status refused = set(host, {target(2, 6500), wrong});
    EXPECT_EQ(refused.number, number(ErrorNumber::invalid_value)) << field;
    EXPECT_NE(refused.sentence().find("targets[1]." + field), std::string::npos) << refused.sentence();
    EXPECT_EQ(list_of(host).SerializeAsString(), before) << field;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  expect_refused("id", [](wire::Target& t) { t.set_id(0); });
  expect_refused("id", [](wire::Target& t) { t.set_id(2); });
  expect_refused("swerling", [](wire::Target& t) { t.set_swerling(5); });
  expect_refused("swerling", [](wire::Target& t) { t.set_swerling(-1); });
  expect_refused("rcs_dbsm", [&](wire::Target& t) { t.set_rcs_dbsm(nan); });
  expect_refused("latitude_deg", [](wire::Target& t) { t.set_latitude_deg(90.1); });
  expect_refused("longitude_deg", [&](wire::Target& t) { t.set_longitude_deg(infinity); });
  expect_refused("height_m", [](wire::Target& t) { t.set_height_m(2e6); });
  expect_refused("velocity_up_m_s", [](wire::Target& t) { t.set_velocity_up_m_s(20001); });
  expect_refused("acceleration_east_m_s2", [&](wire::Target& t) { t.set_acceleration_east_m_s2(nan); });
  expect_refused("height_reference",
                 [](wire::Target& t) { t.set_height_reference(static_cast<wire::HeightReference>(9)); });
  expect_refused("type", [](wire::Target& t) { t.set_type("tank"); });
  expect_refused("length_m", [](wire::Target& t) { t.set_length_m(-1); });
  expect_refused("top_m", [&](wire::Target& t) { t.set_top_m(nan); });
  expect_refused("valid_s", [&](wire::Target& t) { t.set_valid_s(nan); });
  expect_refused("sim_time_ns", [](wire::Target& t) { t.set_sim_time_ns(INT64_MAX); });
  expect_refused("age_s", [](wire::Target& t) { t.set_age_s(1); });
  expect_refused("age_s", [&](wire::Target& t) { t.clear_sim_time_ns(), t.set_age_s(-infinity); });
  expect_refused("route", [](wire::Target& t) { t.mutable_route()->add_latitude_deg(33); });
  expect_refused("route", [](wire::Target& t) {
    t.set_velocity_north_m_s(1);
    t.mutable_route()->add_latitude_deg(33);
    t.mutable_route()->add_longitude_deg(-99);
    t.mutable_route()->add_speed_m_s(3);
  });
  expect_refused("route[0].speed_m_s", [](wire::Target& t) {
    t.mutable_route()->add_latitude_deg(33);
    t.mutable_route()->add_longitude_deg(-99);
    t.mutable_route()->add_speed_m_s(0);
  });
  expect_refused("name", [](wire::Target& t) { t.set_name(std::string(65, 'x')); });
  expect_refused("longitude_deg", [](wire::Target& t) {
    t = {};
    t.set_id(3);
    t.set_latitude_deg(33);
  });
  const Status too_many = set(host, {target(3, 1000), target(4, 1000)});
  EXPECT_EQ(too_many.number, number(ErrorNumber::over_limit)) << too_many.sentence();
  EXPECT_NE(too_many.sentence().find("max_targets"), std::string::npos);
  EXPECT_EQ(list_of(host).SerializeAsString(), before);
  wire::SetTargets gone;
  for (std::uint64_t id = 1; id <= 100'001; ++id) gone.add_gone(id);
  const Status too_many_gone = set(host, gone);
  EXPECT_EQ(too_many_gone.number, number(ErrorNumber::over_limit)) << too_many_gone.sentence();
  EXPECT_NE(too_many_gone.sentence().find("gone: found 100001"), std::string::npos)
      << too_many_gone.sentence();
  EXPECT_EQ(list_of(host).SerializeAsString(), before);
  // Too large for a message: nothing is sent, not even those before it, and the next change is as it was.
  std::vector<wire::Target> large = {target(1, 1000), target(2, 1000), target(3, 1000), target(4, 1000)};
  for (wire::Target& each : large) each.set_name(std::string(60'000, 'x'));
  large.back().set_name(std::string(70'000, 'x'));
  const Status too_large = set(host, large);
  EXPECT_EQ(too_large.outcome, client::Outcome::bad_argument) << too_large.sentence();
  EXPECT_NE(too_large.sentence().find("targets[3]: found 700"), std::string::npos) << too_large.sentence();
  EXPECT_EQ(list_of(host).SerializeAsString(), before);
  EXPECT_TRUE(is_ok(set(host, wire::SetTargets())));
  // Before the newest of its id: left out and counted, which is no mistake.
  wire::Target later = target(1, 5000);
  later.set_sim_time_ns(5);
  ASSERT_TRUE(is_ok(set(host, {later})));
  std::vector<std::string> warnings;
  ASSERT_TRUE(is_ok(host.set_targets(request_of({target(1, 9000)}), warnings)));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("1 late"), std::string::npos) << warnings[0];
  EXPECT_EQ(status_of(host).targets_late(), 1u);
}

}  // namespace
}  // namespace obliq::test::targets_test
