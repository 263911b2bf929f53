// Clients that are thrown out while all clients, or all watchers, are told something.
// The silences that end a connection or do not, and the ports that may be opened at all.
#include <gtest/gtest.h>
#include <netinet/tcp.h>
#include <unistd.h>

#include <boost/asio.hpp>
#include <future>

#include "proto/obliq.pb.h"
#include "server/net/io_thread.h"
#include "server/net/room.h"
#include "server/net/tcp.h"
#include "server/net/transport.h"
#include "server/rendering/replay_control.h"
#include "server/security/networks.h"
#include "terrain/base/errors.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/loopback.h"

namespace obliq::test::leaving_test {
namespace {

using net::Transport;
using wire::MessageType;

/// A bar that clients drag: each wish is news for all of them.
class Bar : public rendering::ReplayControl {
 public:
  std::vector<FieldError> set(const wire::SetReplay&) override {
    changed();
    return {};
  }
  void write_state(wire::ReplayState& state) const override { state.set_radar("main"); }
  void each_event(const std::function<void(const wire::ExerciseEvent&)>&) const override {}
  void keep(const wire::ExerciseEvent&) override {}
  void watched(bool, bool) override {}
  void on_change(std::function<void()> call) override { call_ = std::move(call); }
  void changed() const {
    if (call_) call_();
  }

 private:
  std::function<void()> call_;
};

class ReplayedPattern : public PatternRenderer {
 public:
  std::string fixed() const override { return "a replay"; }
  rendering::ReplayControl* replay() const override { return &bar; }

  mutable Bar bar;
};

template <typename Message>
wire::Bytes message_of(MessageType type, const Message& message) {
  return wire::encode_message(type, {0, 1, 0}, message);
}

wire::Bytes hello() {
  wire::Hello hello;
  hello.set_major(wire::kMajorVersion);
  return message_of(MessageType::hello, hello);
}

/// A connection whose peer has sent all that it will send. It takes what it is written, or nothing.
class Scripted : public Transport {
 public:
  Scripted(boost::asio::io_context& io, wire::Bytes script, bool reads, std::function<void(MessageType)> told)
      : io_(io), script_(std::move(script)), reads_(reads), told_(std::move(told)) {}

  std::string host() const override { return "127.0.0.1"; }
  std::string address() const override { return "127.0.0.1:1"; }
  void start(Started done) override {
    boost::asio::post(io_, [done] { done(Start::ready); });
  }
  bool is_ready() const override { return true; }
  std::string description() const override { return "a script"; }
  void read(std::span<std::byte> bytes, bool some, Done done) override {
    const std::size_t left = script_.size() - taken_;
    if (left < (some ? std::size_t{1} : bytes.size())) return wait(std::move(done));
    const std::size_t n = std::min(left, bytes.size());
    std::copy_n(script_.begin() + static_cast<std::ptrdiff_t>(taken_), n, bytes.begin());
    taken_ += n;
    answer(std::move(done), Transfer::done);
  }
  void write(const stream::Block& message, Done done) override {
    if (!reads_) return wait(std::move(done));
    wire::MessageView view;
    EXPECT_EQ(wire::decode_message(message.bytes, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
    told_(view.header.type);
    answer(std::move(done), Transfer::done);
  }
  void finish(Done done) override { answer(std::move(done), Transfer::done); }
  void close() override {
    for (Done& done : std::exchange(waiting_, {})) answer(std::move(done), Transfer::failed);
  }

 private:
  void answer(Done done, Transfer result) {
    boost::asio::post(io_, [done = std::move(done), result] { done(result); });
  }
  void wait(Done done) { waiting_.push_back(std::move(done)); }

  boost::asio::io_context& io_;
  const wire::Bytes script_;
  const bool reads_;
  const std::function<void(MessageType)> told_;
  std::size_t taken_ = 0;
  std::vector<Done> waiting_;
};

TEST(NetLeaving, TheBarIsDraggedBesideAWatcherThatHasStoppedReading) {
  constexpr int kDrags = 1100;  // more messages than may wait for a client
  const ReplayedPattern renderer;
  net::IoThread io;
  net::ServerOptions options = small_options();
  options.handshake_timeout_s = 60;
  net::Server server(io.context(), renderer, {small_radar("main")}, options,
                     net::ReservedPort("127.0.0.1", 0));
  std::promise<void> stopped;
  server.start([&] { stopped.set_value(); });

  wire::Bytes asleep = hello();
  const wire::Bytes subscribe = message_of(MessageType::subscribe, request_at(1));
  asleep.insert(asleep.end(), subscribe.begin(), subscribe.end());
  wire::Bytes drags = hello();
  for (int k = 0; k < kDrags; ++k) {
    wire::SetReplay wish;
    wish.set_seek_s(k % 7);
    const wire::Bytes bytes = message_of(MessageType::set_replay, wish);
    drags.insert(drags.end(), bytes.begin(), bytes.end());
  }
  std::promise<void> dragged;
  int acks = 0;
  int bystander_told = 0;
  const auto admit = [&](const wire::Bytes& script, bool reads, std::function<void(MessageType)> told) {
    server.admit(std::make_unique<Scripted>(io.context(), script, reads, std::move(told)));
  };
  io.post([&] {
    admit(asleep, false, {});
    admit(hello(), true, [&](MessageType type) { bystander_told += type == MessageType::replay_state; });
    admit(drags, true, [&](MessageType type) {
      if (type == MessageType::ack && ++acks == kDrags) dragged.set_value();
    });
  });
  ASSERT_EQ(dragged.get_future().wait_for(kLong), std::future_status::ready);
  std::promise<std::size_t> clients;
  io.post([&] { clients.set_value(server.statistics().clients); });
  EXPECT_EQ(clients.get_future().get(), 3u) << "news waits for the one that reads nothing, once";
  server.stop();
  ASSERT_EQ(stopped.get_future().wait_for(kLong), std::future_status::ready);
  io.end();
  EXPECT_GE(bystander_told, 2);  // once with its Welcome
  EXPECT_LE(bystander_told, kDrags + 1);
}

/// A client that is gone as soon as it is sent something, as a session is whose peer has stopped reading.
class Listener : public net::Peer, public std::enable_shared_from_this<Listener> {
 public:
  Listener(net::Room& room, std::uint64_t number, bool leaves)
      : Peer(number, "127.0.0.1", "127.0.0.1:" + std::to_string(number), false, 2, 1 << 20),
        room_(room),
        leaves_(leaves) {
    greeted = true;
  }
  using Peer::send;
  void send(MessageType, const google::protobuf::Message&, std::span<const std::byte>) override {
    ++told;
    if (leaves_ && !has_left) room_.leave(shared_from_this());
  }
  void kick() override { room_.tell_news(*this); }
  void fail(wire::ErrorNumber, const std::string&) override {}
  void finish(wire::ErrorNumber, const std::string&) override {}
  void drop() override {}

  int told = 0;

 private:
  net::Room& room_;
  const bool leaves_;
};

/// Three clients that watch the last bins of a radar; the first leaves when it is told anything.
class Told : public ::testing::Test {
 protected:
  Told() {
    for (std::uint64_t k = 0; k < 3; ++k) {
      peers.push_back(std::make_shared<Listener>(room, k + 1, k == 0));
      room.enter(peers.back());
      rendering::Demand demand;
      demand.rate_hz = 1;
      demand.choice.format.window.azimuth.first = 10;
      room.radars().watch(radar(), *peers.back(), demand);
    }
  }
  net::LiveRadar& radar() { return room.radars().at(0); }
  void run_posted() {
    while (!posted.empty()) {
      const auto work = std::move(posted.front());
      posted.pop_front();
      work();
    }
  }
  void expect_each_told_once_and_the_first_gone() {
    for (const auto& peer : peers) EXPECT_EQ(peer->told, 1) << peer->id;
    run_posted();
    EXPECT_EQ(radar().watchers.size(), 2u);
    EXPECT_EQ(room.clients(), 2);
  }

  ReplayedPattern renderer;
  std::deque<std::function<void()>> posted;
  net::Room room{renderer, small_options(), {small_radar("main")}, [this](std::function<void()> work) {
                   posted.push_back(std::move(work));
                 }};
  std::vector<std::shared_ptr<Listener>> peers;
};

TEST_F(Told, AllWatchersHearThatTheirBinsAreGoneThoughOneLeaves) {
  RadarSettings settings = radar().settings.current()->settings;
  settings.azimuth_bins = 8;
  ASSERT_TRUE(radar().settings.set(settings).published);
  room.radars().check_windows(radar());
  expect_each_told_once_and_the_first_gone();
}

TEST_F(Told, AllWatchersHearThatTheRadarCannotBeRenderedThoughOneLeaves) {
  room.radars().note_fault(0, radar().view(), {{"frustum.kind", "oblique", "sweep"}});
  expect_each_told_once_and_the_first_gone();
}

TEST_F(Told, AllClientsHearWhereTheReplayIsThoughOneLeaves) {
  renderer.bar.changed();
  run_posted();
  expect_each_told_once_and_the_first_gone();
}

using client::Outcome;
using client::Status;
using wire::ErrorNumber;

TEST(Silence, AClientThatAnswersHeartbeatsOutlivesTheIdleTimeout) {
  net::ServerOptions options = small_options();
  options.heartbeat_s = 0.02;
  options.idle_timeout_s = 2;  // a hundred chances to answer
  const TestServer server(options);
  client::Client client = connect(server);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(4);
  while (std::chrono::steady_clock::now() < end) {
    const Status status = client.receive(client::Timeout(100));
    ASSERT_TRUE(status.ok() || status.outcome == Outcome::timed_out) << status.sentence();
  }
  wire::RadarList list;
  EXPECT_TRUE(client.list_radars(list).ok());
}

TEST(Silence, WithoutAnIdleTimeoutAClientOfOldThatSkipsHeartbeatsStays) {
  net::ServerOptions options = small_options();
  options.heartbeat_s = 0.01;
  const TestServer server(options);
  RawPeer peer(server);
  peer.send(hello_bytes());
  for (int i = 0; i < 50; ++i) {
    wire::Heartbeat heartbeat;
    ASSERT_TRUE(peer.await(wire::MessageType::heartbeat, heartbeat));
  }
  wire::ListRadars request;
  peer.send(wire::encode_message(wire::MessageType::list_radars, {0, 2, wire::utc_now_ns()}, request));
  wire::RadarList list;
  EXPECT_TRUE(peer.await(wire::MessageType::radar_list, list));
}

TEST(Silence, AServerThatMissesItsHeartbeatsIsTakenForDead) {
  // Welcomes, promises a heartbeat every 20 ms, and hangs.
  const int listening = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const std::uint16_t port = bind_to_loopback(listening);
  ASSERT_EQ(::listen(listening, 1), 0);
  wire::Welcome welcome;
  welcome.set_request_id(1);
  welcome.set_major(wire::kMajorVersion);
  welcome.mutable_limits()->set_heartbeat_s(0.02);
  const wire::Bytes bytes = wire::encode_message(wire::MessageType::welcome, {0, 1, 0}, welcome);
  int accepted = -1;
  std::thread hung([&] {
    accepted = ::accept(listening, nullptr, nullptr);
    (void)!::send(accepted, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  });
  client::Client client;
  EXPECT_TRUE(is_ok(client.connect({"127.0.0.1", port}, {.name = "tester"})));
  Status end;
  do {
    end = client.receive(client::Timeout(50));
  } while (end.outcome == Outcome::timed_out);
  EXPECT_EQ(end.outcome, Outcome::closed);
  EXPECT_NE(end.text.find("has said nothing"), std::string::npos) << end.text;
  EXPECT_FALSE(client.is_open());
  hung.join();
  ::close(accepted);
  ::close(listening);
}

TEST(Silence, TheKernelIsToldWhenToGiveADeadPeerUp) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const auto option = [&](int level, int name) {
    int value = -1;
    socklen_t size = sizeof value;
    EXPECT_EQ(::getsockopt(fd, level, name, &value, &size), 0);
    return value;
  };
  for (const double dead_after_s : {60.0, 4.0, 7.3, 0.0, 1e300}) {
    ASSERT_TRUE(net::watch_for_dead_peer(fd, dead_after_s));
    EXPECT_EQ(option(SOL_SOCKET, SO_KEEPALIVE), 1);
    const int idle_s = option(IPPROTO_TCP, TCP_KEEPIDLE);
    const int probing_s = option(IPPROTO_TCP, TCP_KEEPINTVL) * option(IPPROTO_TCP, TCP_KEEPCNT);
    const int total_s = option(IPPROTO_TCP, TCP_USER_TIMEOUT) / 1000;
    EXPECT_EQ(idle_s + probing_s, total_s) << dead_after_s;
    EXPECT_GE(total_s, net::kMinDeadAfter_s);
    if (dead_after_s == 60) {
      EXPECT_EQ(total_s, 60);
    }
  }
  ::close(fd);
}

TEST(Exposure, OffLoopbackAPortNeedsProtectionOrAPlainWord) {
  const auto complaint = [](const std::string& address, bool tls, bool tokens,
                            bool unprotected) -> std::string {
    try {
      security::require_protection("server.address", address, {{"TLS", tls}, {"tokens", tokens}},
                                   "server.unprotected", unprotected);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  for (const std::string here : {"127.0.0.1", "127.8.9.10", "::1", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(security::resolves_to_loopback(here)) << here;
    EXPECT_EQ(complaint(here, false, false, false), "");
  }
  for (const std::string everywhere :
       {"0.0.0.0", "::", "192.0.2.1", "2001:db8::1", "no such host.invalid", ""}) {
    EXPECT_FALSE(security::resolves_to_loopback(everywhere)) << everywhere;
    EXPECT_NE(complaint(everywhere, false, false, false).find("without TLS and tokens"), std::string::npos);
    EXPECT_NE(complaint(everywhere, true, false, false).find("without tokens;"), std::string::npos);
    EXPECT_NE(complaint(everywhere, false, true, false).find("without TLS;"), std::string::npos);
    EXPECT_EQ(complaint(everywhere, true, true, false), "");
    EXPECT_EQ(complaint(everywhere, false, false, true), "");
  }
}

}  // namespace
}  // namespace obliq::test::leaving_test
