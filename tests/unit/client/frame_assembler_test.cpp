// What the client's assembler makes of frames that claim more than they bring.
// What the kernel is told about a connection.
#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>

#include "client/socket.h"
#include "proto/obliq.pb.h"
#include "server/net/io_thread.h"
#include "server/net/socket_transport.h"
#include "server/security/networks.h"
#include "tests/integration/clients.h"
#include "tests/support/loopback.h"
#include "tests/unit/stream/encoder_fixture.h"

namespace obliq::test::frame_assembler_test {
namespace {

using namespace net;
using client::FrameAssembler;
using client::parse_endpoint;

/// A pass of which the first wedges come.
struct Pass {
  explicit Pass(int n_azimuth = 24, int n_range = 32, int wedges = 1,
                const stream::StreamChoice& choice = {}) {
    encoder = std::make_unique<stream::FrameEncoder>(
        stream::FrameIdentity{.stream_id = 9, .frame_id = 4, .choices = {choice}}, sequence);
    EXPECT_TRUE(feed(frames, *encoder->begin(descriptor(n_azimuth, n_range)).front()).ok());
    for (int wedge = 0; wedge < wedges; ++wedge) add(wedge, n_range);
  }
  void add(int wedge, int n_range) {
    for (const stream::BlockPtr& block : encoder->wedge(wedge, filled(8 * wedge, 8, n_range))) {
      EXPECT_TRUE(is_ok(feed(frames, *block)));
    }
  }
  client::Status end(const std::vector<AzimuthRange>& missed = {}) {
    return feed(frames, *encoder->end({}, 0, missed));
  }
  std::size_t bytes_allocated() const {
    const client::AssembledFrame& frame = frames.frame();
    return frame.iq.capacity() * sizeof frame.iq[0] + frame.power_w.capacity() * sizeof frame.power_w[0] +
           frame.count.capacity() * sizeof frame.count[0] + frame.state.capacity();
  }

  std::uint64_t sequence = 0;
  std::unique_ptr<stream::FrameEncoder> encoder;
  FrameAssembler frames;
};

TEST(FrameAssembler, WhatAFrameClaimsIsNotAllocatedUntilAPartOfItHasCome) {
  Pass claims(8192, 8192, 0);  // 1.4 GB
  EXPECT_EQ(claims.bytes_allocated(), 0u);
  claims.add(1023, 8192);  // also not when the last bins come first
  EXPECT_EQ(claims.bytes_allocated(), 0u);
}

TEST(FrameAssembler, ALargeFrameIsWholeWhateverCameBeforeItWasAllocated) {
  constexpr int kWedges = 16;
  constexpr int kRanges = 4096;
  Pass large(8 * kWedges, kRanges, 0);  // 11 MB
  for (int i = 0; i < kWedges; ++i) {
    EXPECT_EQ(large.bytes_allocated() > 0, i >= 2) << i << " of " << kWedges << " wedges have come";
    large.add((i * 5 + 3) % kWedges, kRanges);
  }
  ASSERT_TRUE(large.end().ok());
  const BinBlock whole = filled(0, 8 * kWedges, kRanges);
  EXPECT_TRUE(large.frames.frame().iq == whole.iq);
  EXPECT_TRUE(large.frames.frame().power_w == whole.power_w);
  EXPECT_TRUE(large.frames.frame().count == whole.count);
  EXPECT_TRUE(large.frames.frame().state == whole.state);
}

TEST(FrameAssembler, OfALargePassAFewPerCentAreEnoughAndLessIsGivenUp) {
  Pass some(1024, 1024, 3);
  ASSERT_TRUE(some.end({{24, 1000}}).ok());
  EXPECT_EQ(some.frames.state(), FrameAssembler::State::complete);
  EXPECT_EQ(some.frames.frame().power_w.size(), std::size_t{1024} * 1024);
  Pass least(1024, 1024, 1);
  ASSERT_TRUE(least.end({{8, 1016}}).ok());
  EXPECT_EQ(least.frames.state(), FrameAssembler::State::aborted);
  EXPECT_EQ(least.frames.abort_reason(), "the scanning antenna missed nearly all of it");
  EXPECT_EQ(least.bytes_allocated(), 0u);
}

TEST(FrameAssembler, MoreAzimuthBinsThanAnyRadarHasAreRefused) {
  for (const int n : {1 << 14, (1 << 14) + 1}) {
    FrameAssembler frames;
    wire::FrameBegin begin;
    *begin.mutable_frame() = descriptor(n, 1);
    EXPECT_EQ(frames.on_begin({}, begin).ok(), n == 1 << 14) << n;
  }
}

TEST(FrameAssembler, WhatAPassMissedIsNotSampled) {
  Pass pass;
  ASSERT_TRUE(pass.end({{8, 8}, {16, 8}}).ok());
  BinBlock expected(0, 24, 32);
  const BinBlock came = filled(0, 8, 32);
  std::copy(came.power_w.begin(), came.power_w.end(), expected.power_w.begin());
  std::copy(came.state.begin(), came.state.end(), expected.state.begin());
  EXPECT_EQ(pass.frames.frame().power_w, expected.power_w);
  EXPECT_EQ(pass.frames.frame().state, expected.state);
  EXPECT_EQ(pass.frames.frame().missed, (std::vector<std::pair<int, int>>{{8, 8}, {16, 8}}));
}

/// A frame of trains alone, each value telling where it belongs.
struct Trains {
  static constexpr int kPulses = 20;
  explicit Trains(int ranges = 32, const wire::Window& window = {},
                  wire::IqEncoding iq = wire::IqEncoding::cf32_le)
      : n_range(ranges), frames(wire::kPulsesPlane) {
    stream::StreamChoice choice;
    choice.planes = wire::kPulsesPlane;
    choice.format = {.iq = iq, .window = window};
    encoder = std::make_unique<stream::FrameEncoder>(
        stream::FrameIdentity{.stream_id = 9, .frame_id = 4, .choices = {choice}}, sequence);
    wire::FrameDescriptor message = descriptor(24, n_range);
    message.mutable_settings()->set_doppler_pulses(kPulses);
    EXPECT_TRUE(feed(frames, *encoder->begin(message).front()).ok());
  }
  std::vector<stream::BlockPtr> blocks(int first_azimuth) {
    PulseTrain train{{first_azimuth, 8}, kPulses, n_range, {1e6, 2e6}, 12.5, -30, {}};
    for (int k = 0; k < kPulses * n_range; ++k)
      train.iq.emplace_back(static_cast<float>(k), static_cast<float>(first_azimuth));
    return encoder->train(train);
  }
  client::Status add(int first_azimuth) {
    for (const stream::BlockPtr& block : blocks(first_azimuth))
      if (const client::Status status = feed(frames, *block); !status.ok()) return status;
    return {};
  }
  client::Status end() { return feed(frames, *encoder->end({}, 0)); }

  int n_range;
  std::uint64_t sequence = 0;
  std::unique_ptr<stream::FrameEncoder> encoder;
  FrameAssembler frames;
};

TEST(FrameAssembler, TrainsOfPulsesComeWhole) {
  Trains two;
  ASSERT_TRUE(two.add(0).ok());
  ASSERT_TRUE(two.add(16).ok());
  ASSERT_TRUE(two.end().ok());
  const client::AssembledFrame frame = two.frames.take();
  ASSERT_EQ(frame.trains.size(), 2u);
  const client::AssembledTrain& train = frame.trains[1];
  EXPECT_EQ(train.first_azimuth, 16);
  EXPECT_EQ(train.n_azimuth, 8);
  EXPECT_EQ(train.n_pulses, Trains::kPulses);
  EXPECT_EQ(train.n_range, 32);
  EXPECT_EQ(train.period_ns, (std::vector<double>{1e6, 2e6}));
  EXPECT_EQ(train.boresight_start_deg, 12.5);
  EXPECT_EQ(train.boresight_rate_deg_s, -30);
  for (std::size_t k = 0; k < train.iq.size(); ++k)
    ASSERT_EQ(train.iq[k], std::complex<float>(static_cast<float>(k), 16));
}

TEST(FrameAssembler, TrainsAreCutAtABlocksSizeAndByAWindow) {
  Trains large(8192);  // 65,536 bytes a pulse: sixteen in a block
  EXPECT_EQ(large.blocks(0).size(), 2u);
  Trains part(32, {{}, {4, 24, 5}});
  ASSERT_TRUE(part.add(0).ok());
  ASSERT_TRUE(part.end().ok());
  const client::AssembledTrain& train = part.frames.frame().trains.front();
  ASSERT_EQ(train.n_range, 5);
  EXPECT_EQ(train.iq[5 + 2].real(), 32 + 4 + 2 * 5);
  Trains elsewhere(32, {{8, 8, 1}, {}});
  EXPECT_TRUE(elsewhere.blocks(0).empty()) << "none of its azimuths was asked for";
  EXPECT_EQ(elsewhere.blocks(8).size(), 1u);
}

TEST(FrameAssembler, TrainsWithGapsAreRefused) {
  Trains cut(8192);
  ASSERT_TRUE(feed(cut.frames, *cut.blocks(0).front()).ok());
  EXPECT_EQ(cut.end().text, "the frame ended within a train of pulses");
  Trains late(8192);
  EXPECT_EQ(feed(late.frames, *late.blocks(0).back()).text,
            "a block of pulses overlaps another or leaves a gap");
  Trains twice(8192);
  ASSERT_TRUE(feed(twice.frames, *twice.blocks(0).front()).ok());
  EXPECT_FALSE(feed(twice.frames, *twice.blocks(0).front()).ok());
  Trains mixed(8192);
  ASSERT_TRUE(feed(mixed.frames, *mixed.blocks(0).front()).ok());
  EXPECT_FALSE(feed(mixed.frames, *mixed.blocks(8).back()).ok());
  Trains beyond;
  EXPECT_EQ(beyond.add(20).text, "a train of pulses does not fit the frame");
}

TEST(FrameAssembler, APassCannotMissMoreThanItHas) {
  // Each span costs its length: the largest message has room for as many as would cost minutes.
  Pass pass;
  const client::Status status = pass.end(std::vector<AzimuthRange>(1000, AzimuthRange{0, 24}));
  EXPECT_EQ(status.outcome, client::Outcome::bad_stream);
  EXPECT_NE(status.text.find("more azimuth bins were missed than the frame has"), std::string::npos)
      << status.text;
}

TEST(FrameAssembler, AWindowMayBeNarrowerThanThePassHasGaps) {
  stream::StreamChoice choice;
  choice.format.window = {{4, 1, 1}, {}};
  Pass pass(24, 32, 1, choice);
  EXPECT_TRUE(pass.end({{8, 1}, {16, 1}}).ok());
}

TEST(Endpoint, TakesHostsAndPorts) {
  EXPECT_EQ(parse_endpoint("radar.example:99")->text(), "radar.example:99");
  EXPECT_EQ(parse_endpoint("10.0.0.1")->text(), "10.0.0.1:7420");
  EXPECT_EQ(parse_endpoint("[::1]:80")->host, "::1");
  EXPECT_EQ(parse_endpoint("[::1]:80")->text(), "[::1]:80");
  EXPECT_EQ(parse_endpoint("[::1]")->port, 7420);
  EXPECT_EQ(parse_endpoint(":99")->text(), "127.0.0.1:99");
  EXPECT_EQ(parse_endpoint("99")->text(), "127.0.0.1:99");
}

TEST(Endpoint, RefusesWhatIsNone) {
  for (const char* text : {"", ":", "0", "65536", ":0", ":65536", "1:2:3", "host:", "host:0", "host:65536",
                           "host:-1", "host:12x", "host: 12", "[::1", "[::1]80", "::1", "[]:5"}) {
    EXPECT_FALSE(parse_endpoint(text).has_value()) << text;
  }
}

/// What a transport makes of the send buffer and the peer's address, when a peer on 127.0.0.1 comes to a
/// listener of IPv4, or to one of IPv6 that takes IPv4 as well. False: no IPv6 here.
bool look(bool dual_stack, int& send_bytes, std::string& host) {
  const int family = dual_stack ? AF_INET6 : AF_INET;
  const int listener = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listener < 0) return false;
  sockaddr_storage address{};  // all zeros: any address, any port
  address.ss_family = static_cast<sa_family_t>(family);
  socklen_t size = dual_stack ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
  const int off = 0;
  if (dual_stack) (void)::setsockopt(listener, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  if (::bind(listener, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
    ::close(listener);
    return false;
  }
  EXPECT_EQ(::listen(listener, 1), 0);
  EXPECT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const int peer = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  test::connect_to_loopback(peer, ntohs(dual_stack ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                                   : reinterpret_cast<const sockaddr_in&>(address).sin_port));
  const int accepted = ::accept(listener, nullptr, nullptr);
  {
    net::IoThread io;
    const net::SocketTransport transport(io.context(), accepted, dual_stack, nullptr);
    host = transport.host();
    socklen_t length = sizeof send_bytes;
    EXPECT_EQ(::getsockopt(accepted, SOL_SOCKET, SO_SNDBUF, &send_bytes, &length), 0);
    io.end();
  }
  ::close(peer);
  ::close(listener);
  return true;
}

TEST(Transport, APeerOfThisMachineHasTheSameSendBufferWhateverClothesItsAddressWears) {
  int plain_bytes = 0;
  int mapped_bytes = 0;
  std::string host;
  ASSERT_TRUE(look(false, plain_bytes, host));
  EXPECT_EQ(host, "127.0.0.1");
  if (!look(true, mapped_bytes, host)) GTEST_SKIP() << "no IPv6 here";
  EXPECT_EQ(host, "::ffff:127.0.0.1");
  EXPECT_EQ(mapped_bytes, plain_bytes);
}

TEST(Exposure, LoopbackInIPv6ClothesIsLoopback) {
  for (const char* here : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1", "localhost"})
    EXPECT_TRUE(security::resolves_to_loopback(here)) << here;
  for (const char* everywhere : {"0.0.0.0", "::", "::ffff:192.0.2.7", "192.0.2.7", ""})
    EXPECT_FALSE(security::resolves_to_loopback(everywhere)) << everywhere;
}

}  // namespace
}  // namespace obliq::test::frame_assembler_test
