// When datagrams are due, and that they go out in order.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "server/asterix/paced_sender.h"
#include "terrain/base/errors.h"

namespace obliq::asterix {
namespace {

using namespace std::chrono_literals;
using Clock = Pace::Clock;

TEST(Cat240Pace, DatagramsAreSpreadEvenlyOverThePeriod) {
  Pace pace;
  const Clock::time_point now{10s};
  const auto times = pace.spread(now, 1000, 100ms);
  EXPECT_EQ(times.at(0), now);
  EXPECT_EQ(times.at(500), now + 50ms);
  const auto next = pace.spread(now + 100ms, 1000, 100ms);
  EXPECT_EQ(next.at(0), now + 100ms);
}

TEST(Cat240Pace, AFrameThatComesEarlyFollowsTheOneBeforeItAndEndsInTime) {
  Pace pace;
  const Clock::time_point now{10s};
  (void)pace.spread(now, 1000, 100ms);
  const auto early = pace.spread(now + 40ms, 400, 100ms);
  EXPECT_EQ(early.at(0), now + 100ms);
  EXPECT_EQ(early.at(400), now + 140ms);
}

TEST(Cat240Pace, FramesInABurstAreNotSqueezedToNothing) {
  Pace pace;
  const Clock::time_point now{10s};
  Clock::time_point end = now;
  for (int frame = 0; frame < 5; ++frame) {
    const auto times = pace.spread(now, 1000, 100ms);
    EXPECT_GE(times.at(0), end);
    EXPECT_GE(times.step, 25us);
    end = times.at(1000);
  }
}

TEST(Cat240Pace, ThePeriodIsThatOfTheFramesAndNotOfOnePause) {
  FramePeriod period(10);
  Clock::time_point now{10s};
  EXPECT_EQ(period.next(now), 100ms);
  EXPECT_EQ(period.next(now += 250ms), 100ms);
  EXPECT_EQ(period.next(now += 250ms), 250ms) << "the server renders four frames a second";
  EXPECT_EQ(period.next(now += 60s), 250ms) << "a pause";
  EXPECT_EQ(period.next(now += 250ms), 250ms);
  EXPECT_EQ(period.next(now += 1ms), 100ms) << "never closer than was asked for";
}

TEST(Cat240Pace, DwellsOfAReplayThatIsFasterThanTheAntennaWasDoNotPileUp) {
  Pace pace;
  DwellPeriod dwells;
  Clock::time_point now{10s};
  for (int dwell = 0; dwell < 1000; ++dwell) {  // ten times as fast
    now += 4ms;
    const auto times = pace.spread(now, 8, dwells.next(now, 40ms));
    EXPECT_LT(times.at(0) - now, 200ms) << dwell;
  }
  EXPECT_NEAR(std::chrono::duration<double>(dwells.next(now + 4ms, 40ms)).count(), 0.004, 1e-4);
}

TEST(Cat240Pace, DwellsThatComeBunchedAreSpreadAsTheBeamMoves) {
  Pace pace;
  DwellPeriod dwells;
  Clock::time_point now{10s};
  for (int dwell = 0; dwell < 100; ++dwell) {
    now += dwell % 5 == 0 ? 196ms : 1ms;  // five every 200 ms
    const auto times = pace.spread(now, 8, dwells.next(now, 40ms));
    EXPECT_GT(times.step, 500us) << dwell;
    EXPECT_LT(times.at(0) - now, 250ms);
  }
}

/// A socket of the loopback that receives.
class Receiver {
 public:
  Receiver() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<sockaddr*>(&at), size), 0);
    EXPECT_EQ(getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
    to = "127.0.0.1:" + std::to_string(ntohs(at.sin_port));
  }
  Bytes receive() {
    Bytes bytes(kMostDatagram);
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }
  std::string to;

 private:
  UniqueFd socket_;
};

TEST(Cat240Sender, DatagramsArriveInOrderWithTheirTimeOfDay) {
  Receiver receiver;
  PacedSender sender(UdpTarget({.to = receiver.to}));
  std::vector<Bytes> messages;
  for (int i = 0; i < 40; ++i) messages.push_back(summary_message({}, std::to_string(i)));
  const std::int64_t noon_ns = 12 * 3600 * std::int64_t{1'000'000'000};
  sender.queue(messages, {Clock::now(), 1ms}, noon_ns);
  for (Bytes& expected : messages) {
    stamp(expected, noon_ns);
    EXPECT_EQ(receiver.receive(), expected);
  }
  sender.drain();
  EXPECT_EQ(sender.counts().sent, 40u);
  EXPECT_EQ(sender.counts().not_sent, 0u);
}

TEST(Cat240Sender, WhatTheKernelDoesNotTakeIsCounted) {
  // A datagram that is too long for UDP.
  PacedSender sender(UdpTarget({.to = "127.0.0.1:9"}));
  sender.queue({Bytes(70000), Bytes(70000)}, {Clock::now(), {}}, 0);
  sender.drain();
  EXPECT_EQ(sender.counts().not_sent, 2u);
  EXPECT_EQ(sender.counts().error, EMSGSIZE);
  EXPECT_EQ(sender.counts().sent, 0u);
}

TEST(Cat240Sender, BadAddressesAreRefusedWithWhatIsAllowed) {
  for (const char* to :
       {"", "8600", "127.0.0.1", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:65536", "127.0.0.1:86x", ":8600",
        "300.1.1.1:8600", "::1:8600", "0.0.0.0:8600", "255.255.255.255:8600"}) {
    try {
      UdpTarget target({.to = to});
      FAIL() << to;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("--to: found \"") + to + "\""), std::string::npos)
          << error.what();
      EXPECT_NE(std::string(error.what()).find("allowed: HOST:PORT"), std::string::npos) << error.what();
    }
  }
  for (const char* to : {"[::1]:8600", "::1:8600", "::1", "fe80::1%eth0:8600"}) {
    try {
      UdpTarget target({.to = to});
      FAIL() << to;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("an IPv6 address: CAT 240 is sent over IPv4 only"),
                std::string::npos)
          << error.what();
    }
  }
  for (const char* interface : {"lo", "203.0.113.7", "1.2.3"}) {
    try {
      UdpTarget target({.to = "239.192.24.1:8600", .interface = interface});
      FAIL() << interface;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("--interface: found \"") + interface + "\""),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(Cat240Sender, AMulticastGroupOnTheLoopbackIsHeard) {
  UniqueFd socket(::socket(AF_INET, SOCK_DGRAM, 0));
  sockaddr_in at{};
  at.sin_family = AF_INET;
  socklen_t size = sizeof at;
  ASSERT_EQ(bind(socket.get(), reinterpret_cast<sockaddr*>(&at), size), 0);
  ASSERT_EQ(getsockname(socket.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
  ip_mreq group{};
  group.imr_multiaddr.s_addr = inet_addr("239.192.24.1");
  group.imr_interface.s_addr = htonl(INADDR_LOOPBACK);
  if (setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0)
    GTEST_SKIP() << "this machine has no multicast";
  PacedSender sender(UdpTarget(
      {.to = "239.192.24.1:" + std::to_string(ntohs(at.sin_port)), .interface = "127.0.0.1", .ttl = 3}));
  sender.queue({summary_message({}, "hello")}, {Clock::now(), {}}, 0);
  sender.drain();
  ASSERT_EQ(sender.counts().sent, 1u);
  Bytes bytes(100);
  EXPECT_EQ(recv(socket.get(), bytes.data(), bytes.size(), 0), 17);
}

}  // namespace
}  // namespace obliq::asterix
