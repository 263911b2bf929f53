// The silences that end a connection or do not, and the ports that may be opened at all.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "proto/obliq.pb.h"
#include "server/net/tcp.h"
#include "server/security/networks.h"
#include "terrain/base/errors.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test {
namespace {

using client::Outcome;
using client::Status;
using wire::ErrorNumber;

TEST(Silence, TheServerSaysThatItIsThereAndTheClientLibraryAnswers) {
  net::ServerOptions options = small_options();
  options.heartbeat_s = 0.05;
  options.idle_timeout_s = 20;
  const TestServer server(options);
  RawPeer peer(server);
  peer.send(hello_bytes());
  for (int i = 0; i < 3; ++i) {
    wire::Heartbeat heartbeat;
    ASSERT_TRUE(peer.await(wire::MessageType::heartbeat, heartbeat));
    EXPECT_TRUE(heartbeat.answer_wanted());
  }
  // The other way round: asked, the server answers with the same number.
  wire::Heartbeat asked;
  asked.set_request_id(77);
  asked.set_answer_wanted(true);
  peer.send(wire::encode_message(wire::MessageType::heartbeat, {0, 2, wire::utc_now_ns()}, asked));
  wire::Heartbeat answer;
  do {
    ASSERT_TRUE(peer.await(wire::MessageType::heartbeat, answer));
  } while (answer.request_id() == 0);
  EXPECT_EQ(answer.request_id(), 77u);
  EXPECT_FALSE(answer.answer_wanted());
}

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

TEST(Silence, AClientThatSaysNothingForTooLongIsClosedWithTheReason) {
  net::ServerOptions options = small_options();
  options.idle_timeout_s = 0.2;
  const TestServer server(options);
  RawPeer peer(server);
  peer.send(hello_bytes());
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::idle));
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
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof here;
  ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&here), sizeof here), 0);
  ASSERT_EQ(::listen(listening, 1), 0);
  ASSERT_EQ(::getsockname(listening, reinterpret_cast<sockaddr*>(&here), &size), 0);
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
  const Status status = client.connect({"127.0.0.1", ntohs(here.sin_port)}, {.name = "tester"});
  EXPECT_TRUE(status.ok()) << status.sentence();
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
      net::require_protection("server.address", address, {{"TLS", tls}, {"tokens", tokens}},
                              "server.unprotected", unprotected);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  for (const std::string here : {"127.0.0.1", "127.8.9.10", "::1", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(net::resolves_to_loopback(here)) << here;
    EXPECT_EQ(complaint(here, false, false, false), "");
  }
  for (const std::string everywhere :
       {"0.0.0.0", "::", "192.0.2.1", "2001:db8::1", "no such host.invalid", ""}) {
    EXPECT_FALSE(net::resolves_to_loopback(everywhere)) << everywhere;
    EXPECT_NE(complaint(everywhere, false, false, false).find("without TLS and tokens"), std::string::npos);
    EXPECT_NE(complaint(everywhere, true, false, false).find("without tokens;"), std::string::npos);
    EXPECT_NE(complaint(everywhere, false, true, false).find("without TLS;"), std::string::npos);
    EXPECT_EQ(complaint(everywhere, true, true, false), "");
    EXPECT_EQ(complaint(everywhere, false, false, true), "");
  }
}

}  // namespace
}  // namespace obliq::test
