// Targets by message: who may set them, what is refused, what frames and their truth show, when they go.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/rendering/scene_renderer.h"
#include "server/security/security.h"
#include "tests/integration/daemon.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/target_scenes.h"

namespace obliq::test {
namespace {

using client::AssembledFrame;
using client::Status;
using wire::ErrorNumber;
using wire::HiddenBy;
using wire::TargetRecord;

constexpr const char* kViewer = "viewer-token-0123456789";
constexpr const char* kController = "controller-token-0123456789";
constexpr const char* kAdmin = "admin-token-0123456789";

/// Level ground without an echo, 1 km below the antenna, that looks north.
class NetTargets : public testing::Test {
 protected:
  NetTargets() {
    RadarSettings settings = beam_settings();
    settings.range_bins = 200;
    settings.azimuth_bins = 64;
    settings.pixel_columns = 256;
    settings.receiver.noise = true;
    radar_.name = "main";
    radar_.settings = settings;
    radar_.pose = scene_.pose().settings;
    options_ = small_options();
    options_.max_bins = 1'000'000;
    options_.max_memory_mb = 0;
    options_.queue_frames = 3;
  }

  void serve() { server_ = std::make_unique<Server>(*this); }
  client::Client connect(const std::string& token = "", const std::string& name = "tester") {
    client::Client made;
    EXPECT_TRUE(is_ok(made.connect(server_->endpoint(), {.name = name, .token = token})));
    return made;
  }
  client::Client holder(const std::string& token = "") {
    client::Client made = connect(token, "host");
    EXPECT_TRUE(is_ok(made.claim_targets()));
    return made;
  }
  void with_tokens() {
    const std::string path = folder_.write(
        "tokens", std::string("viewer ") + kViewer + "\ncontroller " + kController + "\nadmin " + kAdmin + "\n");
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    options_.security = std::make_shared<net::Security>(net::SecurityFiles{path, "", ""});
  }

  /// So far to the north on the ground, that stands there.
  wire::Target target(std::uint64_t id, double north_m, double east_m = 0) const {
    const Target at = scene_.at(east_m, north_m, 0);
    wire::Target message;
    message.set_id(id);
    message.set_latitude_deg(at.latitude_deg);
    message.set_longitude_deg(at.longitude_deg);
    message.set_rcs_dbsm(30);
    message.set_swerling(0);
    message.set_sim_time_ns(0);
    return message;
  }
  static wire::SetTargets request_of(const std::vector<wire::Target>& targets) {
    wire::SetTargets request;
    for (const wire::Target& target : targets) *request.add_targets() = target;
    return request;
  }
  static Status set(client::Client& client, const wire::SetTargets& request) {
    std::vector<std::string> warnings;
    return client.set_targets(request, warnings);
  }
  static Status set(client::Client& client, const std::vector<wire::Target>& targets) {
    return set(client, request_of(targets));
  }
  static wire::TargetList list_of(client::Client& client) {
    wire::TargetList list;
    EXPECT_TRUE(is_ok(client.get_targets(list)));
    list.clear_request_id();
    return list;
  }

  wire::RenderOnce frame_request(bool live, bool truth, std::int64_t sim_time_ns = 0) const {
    wire::RenderOnce request;
    request.set_radar("main");
    request.set_as_live(true);
    request.mutable_pose()->set_sim_time_ns(sim_time_ns);
    request.add_planes(wire::POWER);
    request.set_live_targets(live);
    request.set_truth(truth);
    return request;
  }
  static AssembledFrame render(client::Client& client, wire::RenderOnce request) {
    client::FrameAssembler frames(wire::plane_bit(wire::Plane::power));
    client.set_handler(&frames);
    EXPECT_TRUE(is_ok(client.render_once(request)));
    EXPECT_TRUE(is_ok(receive_frame(client, frames)));
    client.set_handler(nullptr);
    return frames.take();
  }
  static std::size_t strongest(const std::vector<double>& with, const std::vector<double>& without) {
    std::size_t best = 0;
    for (std::size_t k = 0; k < with.size(); ++k)
      if (with[k] - without[k] > with[best] - without[best]) best = k;
    return best;
  }

  TestFolder folder_;
  TargetScene scene_{level_world()};
  RadarConfig radar_;
  net::ServerOptions options_;

  struct Server {
    explicit Server(const NetTargets& of)
        : renderer(of.scene_.shared(), "level"), server(renderer, {of.radar_}, of.options_) {
      thread = std::thread([this] { server.run(); });
    }
    ~Server() {
      server.stop();
      thread.join();
    }
    client::Endpoint endpoint() const { return {"127.0.0.1", server.port()}; }
    net::SceneRenderer renderer;
    net::Server server;
    std::thread thread;
  };
  std::unique_ptr<Server> server_;
};

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
  // The same bits, whoever asks.
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
  // The bins show the target to all; the blocks beside them to those alone who asked and may.
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
  const wire::Target& now = list_of(host).targets(0);
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
}  // namespace obliq::test
