// Peers that send nonsense, and clients that do not read: each costs itself its connection, and nobody else.
#include <gtest/gtest.h>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::abuse_test {
namespace {

using client::FrameAssembler;
using client::Outcome;
using wire::ErrorNumber;
using wire::MessageType;

/// A server with a client that watches while others misbehave; at the end it must still get frames.
class Abuse : public testing::Test {
 protected:
  Abuse() : watcher(connect(server)) { EXPECT_TRUE(watcher.subscribe("main", 50).ok()); }
  ~Abuse() override {
    FrameAssembler frames;
    const client::Status status = receive_frame(watcher, frames);
    EXPECT_TRUE(status.ok()) << "the other client was disturbed: " << status.sentence();
    wire::RadarList list;
    EXPECT_TRUE(connect(server).list_radars(list).ok()) << "nobody can come any more";
  }

  TestServer server;
  client::Client watcher;
};

TEST_F(Abuse, HalfAHelloAndThenNothingTimesOut) {
  RawPeer peer(server);
  const wire::Bytes hello = hello_bytes();
  peer.send(std::span(hello).first(hello.size() / 2));
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::timed_out));
}

TEST_F(Abuse, HalfARequestAfterHelloTimesOut) {
  RawPeer peer(server);
  const wire::Bytes hello = hello_bytes();
  peer.send(hello);
  peer.send(std::span(hello).first(20));
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::timed_out));
}

TEST_F(Abuse, AnUnknownTypeIsSkippedAndTheNextRequestAnswered) {
  RawPeer peer(server);
  peer.send(hello_bytes());
  wire::GetStatus anything;
  anything.set_request_id(5);
  peer.send(wire::encode_message(static_cast<MessageType>(999), {}, anything));
  wire::Bytes wrong = wire::encode_message(MessageType::get_status, {}, anything);
  wrong.back() ^= std::byte{1};
  peer.send(wrong);
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::bad_crc))
      << "the connection lived on past the unknown type";
}

TEST_F(Abuse, AClientThatAsksWithoutReadingIsHeldBackNotStored) {
  RawPeer peer(server);
  peer.send(hello_bytes());
  wire::GetStatus request;
  const wire::Bytes bytes = wire::encode_message(MessageType::get_status, {}, request);
  wire::Bytes many;
  for (int i = 0; i < 2000; ++i) many.insert(many.end(), bytes.begin(), bytes.end());
  // Until the server stops reading because its answers are not read; it keeps 256 of them, not 400,000.
  bool held_back = false;
  for (int i = 0; i < 200 && !held_back; ++i)
    held_back = !peer.socket().send(many, client::Timeout(300)).ok();
  EXPECT_TRUE(held_back);
}

TEST_F(Abuse, AStalledWatcherGetsNewFramesWhenItReadsAgain) {
  client::Client stalled = connect(server);
  ASSERT_TRUE(stalled.subscribe("main", 100).ok());
  FrameAssembler watched;
  for (int i = 0; i < 20; ++i) {  // while others watch on
    ASSERT_TRUE(receive_frame(watcher, watched).ok());
    watched.take();
  }
  FrameAssembler frames;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(is_ok(receive_frame(stalled, frames)));
    frames.take();
  }
}

TEST(Limits, AClientThatReadsNothingIsDroppedInTheEnd) {
  net::ServerOptions options = small_options();
  options.stall_timeout_s = 0.3;
  const TestServer server(options);
  client::Client watcher = connect(server);
  client::Client stalled = connect(server);
  wire::RenderOnce request = large_once_request();
  ASSERT_TRUE(is_ok(stalled.render_once(request)));
  wire::Status status;
  do {
    ASSERT_TRUE(watcher.get_status(status).ok());
  } while (status.clients() > 1);
  EXPECT_EQ(status.renders_queued(), 0u) << "what it had asked for is forgotten";
  ASSERT_TRUE(watcher.subscribe("main", 50).ok());
  FrameAssembler frames;
  EXPECT_TRUE(receive_frame(watcher, frames).ok());
}

TEST(Limits, TooManySubscriptionsAreRefusedByTheLimitsName) {
  net::ServerOptions options = small_options();
  options.max_subscriptions = 1;
  const TestServer server(options);
  client::Client client = connect(server);
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  ASSERT_TRUE(client.subscribe("main", 20).ok()) << "the same one at another rate";
  const client::Status status = client.subscribe("nose", 50);
  EXPECT_EQ(status.number, number(ErrorNumber::too_many_subscriptions));
  EXPECT_NE(status.text.find("max_subscriptions is 1"), std::string::npos) << status.text;
}

TEST(Limits, APortInUseIsTheOperatorsMistake) {
  const TestServer server;
  net::ServerOptions options = small_options();
  options.port = server.endpoint().port;
  const PatternRenderer renderer;
  try {
    const net::Server second(renderer, {small_radar("main")}, options);
    FAIL() << "two servers on one port";
  } catch (const InputError& e) {
    EXPECT_TRUE(std::string(e.what()).starts_with(
        "cannot listen on 127.0.0.1:" + std::to_string(options.port) + ": Address already in use; end what"))
        << e.what();
  }
}

TEST(Limits, AnAddressOfAnotherMachineIsTheOperatorsMistake) {
  net::ServerOptions options = small_options();
  const PatternRenderer renderer;
  options.address = "192.0.2.1";  // RFC 5737: documentation, nobody's
  EXPECT_THROW(net::Server(renderer, {small_radar("main")}, options), InputError);
  options.address = "no such host.invalid";
  EXPECT_THROW(net::Server(renderer, {small_radar("main")}, options), InputError);
}

/// A server whose frames stand at their second wedge until the gate is opened.
struct GatedServer {
  explicit GatedServer(double stop_limit_s) : server(renderer, options(stop_limit_s)) {}
  ~GatedServer() {
    gate.open();
    if (stopping.joinable()) stopping.join();
  }
  net::ServerOptions options(double stop_limit_s) {
    gate.close();
    net::ServerOptions made = small_options();
    made.stop_limit_s = stop_limit_s;
    renderer.before_wedge = [this](int wedge) {
      if (wedge == 1) gate.pass();
    };
    return made;
  }
  /// Begins to stop. No new connection is taken afterwards: the server has heard.
  void stop() {
    stopping = std::thread([this] { server.stop(); });
    for (bool listening = true; listening;) {
      client::Client late;
      listening = late.connect(server.endpoint(), {.name = "late"}).ok();
    }
  }

  Gate gate;
  PatternRenderer renderer;
  TestServer server;
  std::thread stopping;
};

void await_begin(client::Client& client, const FrameAssembler& frames) {
  while (frames.fraction() == 0) ASSERT_TRUE(client.receive(kLong).ok());
}

/// Receives all that comes before the reason.
void expect_told_of_stop(client::Client& client) {
  client::Status status;
  while (status.ok()) status = client.receive(kLong);
  EXPECT_EQ(status.number, number(ErrorNumber::server_stopping)) << status.sentence();
}

TEST(Stop, FramesThatAreNotDoneWithinTheLimitAreAbortedAndClientsTold) {
  GatedServer gated(0.6);
  client::Client client = connect(gated.server);
  FrameAssembler frames;
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  await_begin(client, frames);
  gated.stop();
  expect_told_of_stop(client);
  EXPECT_EQ(frames.state(), FrameAssembler::State::aborted);
  EXPECT_EQ(frames.abort_reason(), "the server is stopping");
  while (client.receive(kLong).outcome != Outcome::closed) continue;
}

TEST(Stop, ABegunFrameIsFinishedAndReadBeforeTheClientIsTold) {
  GatedServer gated(600);
  client::Client watching = connect(gated.server);
  FrameAssembler live;
  watching.set_handler(&live);
  ASSERT_TRUE(watching.subscribe("main", 50).ok());
  await_begin(watching, live);
  gated.stop();
  gated.gate.open();
  expect_told_of_stop(watching);
  EXPECT_EQ(live.state(), FrameAssembler::State::complete);
}

TEST(Stop, ABegunRenderIsFinishedAndOneThatWaitsIsNot) {
  GatedServer gated(600);
  client::Client first = connect(gated.server);
  client::Client second = connect(gated.server);
  FrameAssembler begun;
  FrameAssembler waiting;
  first.set_handler(&begun);
  second.set_handler(&waiting);
  wire::RenderOnce request = once_request();
  ASSERT_TRUE(first.render_once(request).ok());
  await_begin(first, begun);
  ASSERT_TRUE(second.render_once(request).ok());
  gated.stop();
  gated.gate.open();
  expect_told_of_stop(first);
  expect_told_of_stop(second);
  EXPECT_EQ(begun.state(), FrameAssembler::State::complete);
  EXPECT_NE(waiting.state(), FrameAssembler::State::complete);
}

TEST(Stop, AStalledClientDoesNotDelayIt) {
  TestServer server;
  client::Client stalled = connect(server);
  RawPeer silent(server);
  wire::RenderOnce request = large_once_request();
  ASSERT_TRUE(is_ok(stalled.render_once(request)));
  server.stop();  // returns, or the test times out
}

}  // namespace
}  // namespace obliq::test::abuse_test
