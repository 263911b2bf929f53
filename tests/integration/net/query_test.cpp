// Ground queries over the wire: what is refused and why, and that a long one holds up no other client.
// Frames for one client alone: RenderOnce.
#include <gtest/gtest.h>

#include <thread>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::query_test {
namespace {

using client::Outcome;
using client::Status;
using wire::ErrorNumber;

/// The record says what was asked.
GroundAnswers echo(const GroundQuestion& question) {
  GroundAnswers answers;
  answers.materials = {"ground", "water"};
  for (std::size_t k = 0; k < question.points(); ++k) {
    wire::GroundRecord record;
    record.latitude_deg = question.by_bearing() ? question.bearing_deg[k] : question.latitude_deg[k];
    record.longitude_deg = question.by_bearing() ? question.range_m[k] : question.longitude_deg[k];
    record.point_height_m = question.height_m.empty() ? 0 : question.height_m[k % question.height_m.size()];
    record.building = static_cast<std::uint32_t>(k);
    record.state = wire::GroundState::unknown;
    record.sight = question.antenna ? wire::Sight::behind_building : wire::Sight::not_asked;
    record.material = 1;
    record.water = k % 2 == 1;
    record.slope_deg = 12.5F;
    answers.records.push_back(record);
  }
  return answers;
}

net::ServerOptions with_ground() {
  net::ServerOptions options = small_options();
  options.query_ground = [](const GroundQuestion& question, const std::stop_token&) {
    return echo(question);
  };
  return options;
}

wire::QueryGround places(int points) {
  wire::QueryGround request;
  for (int k = 0; k < points; ++k) {
    request.add_latitude_deg(30 + 1e-4 * k);
    request.add_longitude_deg(-100 - 1e-4 * k);
  }
  return request;
}

Status ask(client::Client& client, wire::QueryGround request) {
  wire::GroundAnswer answer;
  std::vector<wire::GroundRecord> records;
  return client.query_ground(request, answer, records);
}

TEST(NetQuery, TheLargestComesBackWholeAndInOrder) {
  const TestServer server(with_ground());
  client::Client client = connect(server);
  EXPECT_EQ(client.welcome().limits().max_query_points(), wire::kMaxQueryPoints);
  wire::QueryGround request = places(static_cast<int>(wire::kMaxQueryPoints));
  request.set_radar("nose");
  for (std::uint32_t k = 0; k < wire::kMaxQueryPoints; ++k) request.add_height_m(k);
  wire::GroundAnswer answer;
  std::vector<wire::GroundRecord> records;
  ASSERT_TRUE(is_ok(client.query_ground(request, answer, records)));
  ASSERT_EQ(records.size(), wire::kMaxQueryPoints);
  EXPECT_EQ(answer.materials(1), "water");
  EXPECT_EQ(answer.antenna().bearing_deg(), 45);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const wire::GroundRecord& record = records[k];
    ASSERT_EQ(record.latitude_deg, request.latitude_deg(static_cast<int>(k)));
    ASSERT_EQ(record.longitude_deg, request.longitude_deg(static_cast<int>(k)));
    ASSERT_EQ(record.point_height_m, static_cast<double>(k));
    ASSERT_EQ(record.building, k);
    ASSERT_EQ(record.water, k % 2 == 1);
    ASSERT_EQ(record.state, wire::GroundState::unknown);
    ASSERT_EQ(record.sight, wire::Sight::behind_building);
    ASSERT_EQ(record.slope_deg, 12.5F);
  }
}

TEST(NetQuery, WhatCannotBeAnsweredIsRefusedBySentenceAndTheConnectionStays) {
  const TestServer server(with_ground());
  client::Client client = connect(server);
  const auto expect = [&](const wire::QueryGround& request, ErrorNumber error, const std::string& part) {
    const Status status = ask(client, request);
    EXPECT_EQ(status.outcome, Outcome::refused) << status.sentence();
    EXPECT_EQ(status.number, number(error)) << status.sentence();
    EXPECT_NE(status.sentence().find(part), std::string::npos) << status.sentence();
  };
  expect({}, ErrorNumber::invalid_value, "latitude_deg: found no point");
  expect(places(10001), ErrorNumber::over_limit, "max_query_points is 10000");
  wire::QueryGround request = places(3);
  request.set_latitude_deg(2, std::numeric_limits<double>::quiet_NaN());
  expect(request, ErrorNumber::invalid_value, "latitude_deg[2]: found nan; allowed: -90 to 90");
  request = places(3);
  request.mutable_longitude_deg()->RemoveLast();
  expect(request, ErrorNumber::invalid_value, "longitude_deg: found 2 values");
  request = places(1);
  request.set_radar("tail");
  expect(request, ErrorNumber::unknown_radar, "main, nose");
  request.set_radar("main");
  request.mutable_antenna()->set_latitude_deg(1);
  expect(request, ErrorNumber::invalid_value, "antenna: found one, and the radar \"main\"");
  request.clear_radar();
  expect(request, ErrorNumber::invalid_value, "antenna.longitude_deg: found nothing");
  request = places(1);
  request.set_height_reference(static_cast<wire::HeightReference>(7));
  expect(request, ErrorNumber::invalid_value, "height_reference: found 7");
  request = {};
  request.add_bearing_deg(10);
  request.add_range_m(5000);
  expect(request, ErrorNumber::invalid_value, "radar: found none");
  EXPECT_TRUE(ask(client, places(1)).ok());
}

TEST(NetQuery, ALongOneHoldsUpNeitherRequestsNorFramesNorOtherClients) {
  Gate gate;
  gate.close();
  net::ServerOptions options = with_ground();
  options.query_ground = [&gate](const GroundQuestion& question, const std::stop_token&) {
    gate.pass();
    return echo(question);
  };
  const TestServer server(options);
  client::Client asking = connect(server, "asking");
  std::thread waiting([&] { EXPECT_TRUE(ask(asking, places(5)).ok()); });
  gate.await_somebody();
  client::Client other = connect(server, "other");
  EXPECT_EQ(status_of(other).clients(), 2u);
  wire::Subscribe subscribe = request_at(50);
  client::FrameAssembler frames;
  EXPECT_TRUE(other.subscribe(subscribe).ok());
  EXPECT_TRUE(receive_frame(other, frames).ok());
  gate.open();
  waiting.join();
}

TEST(NetQuery, OnlySoManyOfAClientWaitAndThoseOfOneThatLeftAreDropped) {
  Gate gate;
  gate.close();
  std::atomic<int> answered = 0;
  net::ServerOptions options = with_ground();
  options.max_renders_queued = 2;
  options.query_ground = [&](const GroundQuestion& question, const std::stop_token&) {
    gate.pass();
    ++answered;
    return echo(question);
  };
  const TestServer server(options);
  {
    RawPeer peer(server);
    peer.send(hello_bytes());
    wire::QueryGround request = places(1);
    for (std::uint64_t k = 1; k <= 3; ++k) {
      request.set_request_id(k + 1);
      peer.send(wire::encode_message(wire::MessageType::query_ground, {0, k + 1, 0}, request));
    }
    wire::Error error;
    ASSERT_TRUE(peer.await(wire::MessageType::error, error));
    EXPECT_EQ(error.request_id(), 4u);
    EXPECT_EQ(error.number(), number(ErrorNumber::too_many_renders)) << error.text();
    gate.await_somebody();
  }
  client::Client other = connect(server);
  while (status_of(other).clients() > 1) std::this_thread::yield();
  gate.open();
  EXPECT_TRUE(ask(other, places(1)).ok());
  EXPECT_EQ(answered, 2);  // the current one, and the other client's
}

TEST_F(Served, AServerWithoutGroundSaysSo) {
  EXPECT_EQ(client.welcome().limits().max_query_points(), 0u);
  const Status status = ask(client, places(1));
  EXPECT_EQ(status.outcome, Outcome::bad_argument);
  EXPECT_NE(status.sentence().find("answers no ground queries"), std::string::npos);
}

using client::FrameAssembler;

TEST_F(Served, RenderOnceGivesItsOwnFrameAndTouchesNoRadar) {
  wire::RenderOnce request = once_request();
  request.mutable_settings()->set_r_max_m(44000);
  ASSERT_TRUE(client.render_once(request).ok());
  FrameAssembler frames;
  ASSERT_TRUE(receive_frame(client, frames).ok());
  EXPECT_EQ(frames.frame().request_id, request.request_id());
  EXPECT_EQ(frames.frame().descriptor->settings().r_max_m(), 44000);
  EXPECT_EQ(frames.frame().descriptor->settings().frequency_ghz(), 10) << "absent fields take their default";
  expect_pattern(frames.frame());
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().r_max_m(), 37000);
  EXPECT_EQ(info.settings_version(), 1u);
}

TEST_F(Served, RenderOnceAsTheLiveRadarIsTakesWhatItDoesNotNameFromThere) {
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings live;
  live.set_r_max_m(30000);
  live.set_frustum(wire::SWEEP);
  live.set_planes_per_bin(3);
  live.set_receiver_gain_db(7);
  wire::Ack ack;
  ASSERT_TRUE(client.set_settings("main", live, ack).ok());
  wire::Pose pose;
  pose.set_bearing_deg(90);
  pose.set_height_m(1234);
  ASSERT_TRUE(client.set_pose("main", pose, ack).ok());

  wire::RenderOnce request;
  request.set_radar("main");
  request.set_as_live(true);
  request.mutable_settings()->set_azimuth_bins(8);
  request.mutable_pose()->set_tilt_deg(-4);
  ASSERT_TRUE(client.render_once(request).ok());
  FrameAssembler frames;
  ASSERT_TRUE(receive_frame(client, frames).ok());
  const wire::RadarSettings& settings = frames.frame().descriptor->settings();
  EXPECT_EQ(settings.r_max_m(), 30000);
  EXPECT_EQ(settings.receiver_gain_db(), 7);
  EXPECT_EQ(settings.range_bins(), 32);
  EXPECT_EQ(settings.azimuth_bins(), 8);
  EXPECT_EQ(settings.planes_per_bin(), 3);
  EXPECT_EQ(settings.pixel_columns(), 24) << "planes follow the bins";
  EXPECT_EQ(frames.frame().descriptor->pose().bearing_deg(), 90);
  EXPECT_EQ(frames.frame().descriptor->pose().height_m(), 1234);
  EXPECT_EQ(frames.frame().descriptor->pose().tilt_deg(), -4);
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().azimuth_bins(), 20) << "the live radar is not touched";
  EXPECT_EQ(info.settings().pixel_columns(), 60);

  request.set_radar("tail");
  const client::Status refused = client.render_once(request);
  EXPECT_EQ(refused.number, number(wire::ErrorNumber::unknown_radar));
}

TEST_F(Served, AClientOf11GetsTheColumnsThatItSends) {
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_frustum(wire::SWEEP);
  settings.set_planes_per_bin(3);
  wire::Ack ack;
  ASSERT_TRUE(client.set_settings("main", settings, ack).ok());
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().pixel_columns(), 60);
  settings = info.settings();
  settings.clear_planes_per_bin();  // it knows no such field
  settings.set_azimuth_bins(40);
  ASSERT_TRUE(client.set_settings("main", settings, ack).ok());
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().pixel_columns(), 60);
  EXPECT_EQ(info.settings().planes_per_bin(), 0);
}

TEST(RenderOnce, RenderOnceOfAnySizeComesInSlices) {
  net::ServerOptions options = small_options();
  options.slice_bytes = 1;  // one wedge a slice, and each waits until the one before has been taken
  const TestServer server(options);
  client::Client client = connect(server);
  wire::RenderOnce request = once_request();
  ASSERT_TRUE(client.render_once(request).ok());
  FrameAssembler frames;
  ASSERT_TRUE(receive_frame(client, frames).ok());
  EXPECT_EQ(frames.frame().summary->samples(), 3u) << "counts of all slices, added up";
  expect_pattern(frames.frame());
}

TEST(RenderOnce, TooManyRendersAreRefusedByTheLimitsName) {
  Gate gate;
  gate.close();
  net::ServerOptions options = small_options();
  options.max_renders_queued = 2;
  PatternRenderer renderer;
  renderer.before_wedge = [&](int) { gate.pass(); };
  const TestServer server(renderer, options);
  client::Client client = connect(server);
  wire::RenderOnce request = once_request();
  EXPECT_TRUE(client.render_once(request).ok());
  EXPECT_TRUE(client.render_once(request).ok());
  const client::Status status = client.render_once(request);
  EXPECT_EQ(status.number, number(ErrorNumber::too_many_renders));
  EXPECT_NE(status.text.find("max_renders_queued is 2"), std::string::npos);
  gate.open();
  struct Ends : client::FrameHandler {
    int count = 0;
    client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override {
      ++count;
      return {};
    }
  } ends;
  client.set_handler(&ends);
  while (ends.count < 2) ASSERT_TRUE(client.receive(kLong).ok());
  EXPECT_TRUE(client.render_once(request).ok()) << "room again";
}

/// Requests in the order in which their frames begin and end.
struct Order : client::FrameHandler {
  std::vector<std::uint64_t> begun, ended;
  client::Status on_begin(const wire::MessageHeader&, const wire::FrameBegin& begin) override {
    begun.push_back(begin.request_id());
    EXPECT_EQ(begun.size(), ended.size() + 1) << "one frame after the other";
    return {};
  }
  client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override {
    ended.push_back(begun.back());
    return {};
  }
};

TEST(RenderOnce, AClientsFramesComeOneAfterTheOtherInTheOrderOfItsRequests) {
  for (const std::size_t slice_bytes : {std::size_t{1}, std::size_t{1} << 20}) {
    Gate gate;
    gate.close();
    net::ServerOptions options = small_options();
    options.slice_bytes = slice_bytes;
    PatternRenderer renderer;
    renderer.before_wedge = [&](int) { gate.pass(); };
    const TestServer server(renderer, options);
    client::Client client = connect(server), other = connect(server);
    Order order, others;
    client.set_handler(&order);
    other.set_handler(&others);
    std::vector<std::uint64_t> asked, asked_by_other;
    wire::RenderOnce request = once_request();
    for (int k = 0; k < 4; ++k) {
      ASSERT_TRUE(client.render_once(request).ok());
      asked.push_back(request.request_id());
      ASSERT_TRUE(other.render_once(request).ok());
      asked_by_other.push_back(request.request_id());
    }
    gate.open();
    while (order.ended.size() < asked.size()) ASSERT_TRUE(client.receive(kLong).ok());
    while (others.ended.size() < asked_by_other.size()) ASSERT_TRUE(other.receive(kLong).ok());
    EXPECT_EQ(order.ended, asked);
    EXPECT_EQ(others.ended, asked_by_other);
  }
}

}  // namespace
}  // namespace obliq::test::query_test
