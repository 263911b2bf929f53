// Requests whose answers need the ground: they wait for the render thread, and nothing else does.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::appraisal_test {
namespace {

using wire::ErrorNumber;
using wire::MessageType;

/// The pattern over ground that is looked at behind a gate: above 5 km it lies too steeply for the beam.
class GroundBehindAGate : public PatternRenderer {
 public:
  std::vector<FieldError> faults(const RadarSettings&, const PoseSettings& pose) const override {
    ++looks;
    gate.pass();
    if (pose.height_m <= 5000) return {};
    return {{"bins.azimuth", "64", "fewer"}};
  }
  mutable std::atomic<int> looks = 0;
  mutable Gate gate;
};

/// Its sector is widened to the full circle, which its bins do not divide, where the antenna is high
/// (echo_plan_test.cpp).
wire::RadarSettings steep() {
  wire::RadarSettings settings;
  settings.set_sector_deg(250);
  settings.set_azimuth_bins(64);
  settings.set_beam_pattern(wire::UNIFORM_BEAM);
  settings.set_beam_width_deg(10);
  settings.set_beam_extent_deg(25);
  return settings;
}

wire::RadarSettings gain(double db) {
  wire::RadarSettings settings;
  settings.set_gain_db(db);
  return settings;
}

wire::RenderOnce steep_request(std::uint64_t id) {
  wire::RenderOnce request = once_request();
  request.mutable_settings()->MergeFrom(steep());
  request.set_request_id(id);
  return request;
}

struct Answer {
  MessageType type{};
  std::uint64_t request_id = 0;
  std::uint32_t error = 0;
};

/// Sends requests without waiting for their answers.
class Pipeline {
 public:
  explicit Pipeline(const TestServer& server) : peer_(server) {
    peer_.send(hello_bytes());
    EXPECT_EQ(next().type, MessageType::welcome);
  }

  template <typename Request>
  void send(MessageType type, Request request, std::uint64_t id) {
    request.set_request_id(id);
    peer_.send(wire::encode_message(type, {0, ++sequence_, 0}, request));
  }
  void claim(std::uint64_t id, const std::string& radar = "main") {
    wire::ClaimControl request;
    request.set_radar(radar);
    send(MessageType::claim_control, request, id);
  }
  void release(std::uint64_t id) {
    wire::ReleaseControl request;
    request.set_radar("main");
    send(MessageType::release_control, request, id);
  }
  void set(const wire::RadarSettings& settings, std::uint64_t id) {
    wire::SetSettings request;
    request.set_radar("main");
    *request.mutable_settings() = settings;
    send(MessageType::set_settings, request, id);
  }
  void list(std::uint64_t id) { send(MessageType::list_radars, wire::ListRadars(), id); }

  /// The next answer, whatever blocks of frames and heartbeats come before.
  Answer next() {
    wire::Bytes received;
    std::byte one{};
    while (peer_.socket().receive(std::span(&one, 1), kLong).ok()) {
      received.push_back(one);
      wire::MessageView view;
      if (wire::decode_message(received, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok) continue;
      Answer answer{view.header.type, 0, 0};
      wire::Error error;
      wire::Ack ack;
      wire::RadarList list;
      if (answer.type == MessageType::error && wire::parse_descriptor(view.descriptor, error)) {
        answer.request_id = error.request_id();
        answer.error = error.number();
      } else if (answer.type == MessageType::ack && wire::parse_descriptor(view.descriptor, ack)) {
        answer.request_id = ack.request_id();
      } else if (answer.type == MessageType::radar_list && wire::parse_descriptor(view.descriptor, list)) {
        answer.request_id = list.request_id();
      }
      const bool of_a_frame = view.header.stream_id != 0;
      received.clear();
      if (!of_a_frame && answer.type != MessageType::heartbeat) return answer;
    }
    return {};
  }
  std::uint64_t next_id() { return next().request_id; }

 private:
  RawPeer peer_;
  std::uint64_t sequence_ = 1;
};

class GroundRequests : public testing::Test {
 protected:
  GroundBehindAGate renderer_;
  net::ServerOptions options_ = small_options();
};

TEST_F(GroundRequests, KeepNothingElseWaiting) {
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  Pipeline steep(server);
  steep.send(MessageType::render_once, steep_request(1), 1);
  renderer_.gate.await_somebody();
  steep.list(2);
  EXPECT_EQ(steep.next_id(), 2u);
  client::Client other = connect(server);
  EXPECT_EQ(status_of(other).clients(), 2u);
  renderer_.gate.open();
  EXPECT_EQ(steep.next_id(), 1u);
}

TEST_F(GroundRequests, AreAnsweredInTheirOrder) {
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  Pipeline client(server);
  client.claim(9);
  EXPECT_EQ(client.next_id(), 9u);
  client.set(steep(), 10);
  client.send(MessageType::subscribe, request_at(10), 11);
  client.send(MessageType::render_once, once_request(), 12);
  client.set(gain(3), 13);
  client.list(14);
  EXPECT_EQ(client.next_id(), 14u);
  renderer_.gate.open();
  for (const std::uint64_t id : {10u, 11u, 12u, 13u}) {
    const Answer answer = client.next();
    EXPECT_EQ(answer.type, MessageType::ack) << answer.error;
    EXPECT_EQ(answer.request_id, id);
  }
}

TEST_F(GroundRequests, AreRefusedByWhatTheGroundSays) {
  const TestServer server(renderer_, options_);
  client::Client client = connect(server);
  wire::RenderOnce request = steep_request(1);
  EXPECT_TRUE(client.render_once(request).ok());
  request.mutable_pose()->set_height_m(6000);
  const client::Status status = client.render_once(request);
  EXPECT_EQ(status.number, number(ErrorNumber::invalid_value)) << status.sentence();
  EXPECT_NE(status.sentence().find("bins.azimuth: found 64; allowed: fewer"), std::string::npos)
      << status.sentence();
}

TEST_F(GroundRequests, GoWithTheirClient) {
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  Pipeline stays(server);
  stays.send(MessageType::render_once, steep_request(1), 1);
  renderer_.gate.await_somebody();
  {
    Pipeline leaves(server);
    leaves.send(MessageType::render_once, steep_request(1), 1);
    leaves.send(MessageType::render_once, steep_request(2), 2);
    leaves.list(3);
    EXPECT_EQ(leaves.next_id(), 3u);
  }
  client::Client other = connect(server);
  while (status_of(other).clients() > 2) std::this_thread::yield();
  stays.send(MessageType::render_once, steep_request(2), 2);
  renderer_.gate.open();
  EXPECT_EQ(stays.next_id(), 1u);
  EXPECT_EQ(stays.next_id(), 2u);
  EXPECT_EQ(renderer_.looks, 2) << "nobody waits for the others any more";
}

TEST_F(GroundRequests, OfAClientThatLeftWhileTheyWereLookedAtAreForgotten) {
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  {
    Pipeline leaves(server);
    leaves.send(MessageType::render_once, steep_request(1), 1);
    renderer_.gate.await_somebody();
  }
  client::Client other = connect(server);
  while (status_of(other).clients() > 1) std::this_thread::yield();
  renderer_.gate.open();
  wire::RenderOnce request = steep_request(1);
  EXPECT_TRUE(other.render_once(request).ok());
}

TEST_F(GroundRequests, OfOneClientWaitInLimitedNumber) {
  options_.max_renders_queued = 2;
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  Pipeline client(server);
  for (const std::uint64_t id : {1u, 2u, 3u}) client.send(MessageType::render_once, steep_request(id), id);
  const Answer refused = client.next();
  EXPECT_EQ(refused.request_id, 3u);
  EXPECT_EQ(refused.error, number(ErrorNumber::too_many_renders));
  renderer_.gate.open();
  EXPECT_EQ(client.next_id(), 1u);
  EXPECT_EQ(client.next_id(), 2u);
}

TEST_F(GroundRequests, AreJudgedByTheControlOfTheMomentInWhichTheyTakeEffect) {
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  Pipeline first(server);
  first.claim(1);
  first.set(steep(), 2);
  first.release(3);
  EXPECT_EQ(first.next_id(), 1u);
  EXPECT_EQ(first.next_id(), 3u);
  Pipeline second(server);
  second.claim(1);
  EXPECT_EQ(second.next().type, MessageType::ack);
  renderer_.gate.open();
  const Answer refused = first.next();
  EXPECT_EQ(refused.request_id, 2u);
  EXPECT_EQ(refused.error, number(ErrorNumber::controlled_by_other));
}

TEST_F(GroundRequests, AreJudgedAgainWhereAnotherHasChangedTheRadarMeanwhile) {
  renderer_.gate.close();
  const TestServer server(renderer_, options_);
  Pipeline first(server);
  first.claim(1);
  first.set(steep(), 2);
  renderer_.gate.await_somebody();
  first.release(3);
  EXPECT_EQ(first.next_id(), 1u);
  EXPECT_EQ(first.next_id(), 3u);
  Pipeline second(server);
  second.claim(1);
  second.set(gain(7), 2);
  second.release(3);
  for (const std::uint64_t id : {1u, 2u, 3u}) EXPECT_EQ(second.next_id(), id);
  first.claim(4);
  EXPECT_EQ(first.next_id(), 4u);
  renderer_.gate.open();
  EXPECT_EQ(first.next_id(), 2u);
  EXPECT_EQ(renderer_.looks, 2);
  client::Client other = connect(server);
  wire::RadarInfo info;
  ASSERT_TRUE(other.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().gain_db(), 7) << "of the other client";
  EXPECT_EQ(info.settings().sector_deg(), 250);
}

TEST_F(GroundRequests, DoNotKeepTheServerFromStopping) {
  renderer_.gate.close();
  TestServer server(renderer_, options_);
  Pipeline client(server);
  client.send(MessageType::render_once, steep_request(1), 1);
  renderer_.gate.await_somebody();
  std::jthread stop([&] { server.stop(); });
  // The render thread is asked to finish, and cut off after stop_limit_s.
  const Answer last = client.next();
  EXPECT_EQ(last.error, number(ErrorNumber::server_stopping));
  renderer_.gate.open();
}

/// The pattern, whose plans take as long as a gate is closed.
class PlansBehindAGate : public PatternRenderer {
 public:
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override {
    gate.pass();
    return PatternRenderer::plan(settings, pose);
  }
  mutable Gate gate;
};

TEST(LongPlans, KeepNobodyWaitingButTheFrame) {
  PlansBehindAGate renderer;
  renderer.gate.close();
  const TestServer server(renderer, small_options());
  Pipeline client(server);
  client.send(MessageType::render_once, once_request(), 1);
  EXPECT_EQ(client.next_id(), 1u);
  renderer.gate.await_somebody();
  client.list(2);
  EXPECT_EQ(client.next_id(), 2u);
  client.claim(3);
  EXPECT_EQ(client.next_id(), 3u);
  client.set(gain(3), 4);
  EXPECT_EQ(client.next_id(), 4u);
  client::Client other = connect(server);
  EXPECT_EQ(status_of(other).clients(), 2u);
  renderer.gate.open();
}

}  // namespace
}  // namespace obliq::test::appraisal_test
