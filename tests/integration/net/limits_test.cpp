// The operator's limits, each refused by its own name.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <limits>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/net/requests/request_limits.h"
#include "server/radar/wedge_memory.h"
#include "server/security/networks.h"
#include "terrain/base/memory_limit.h"
#include "terrain/base/process.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/loopback.h"
#include "tests/support/radar_settings.h"

namespace obliq::test::limits_test {
namespace {

using client::Outcome;
using client::Status;
using wire::ErrorNumber;

/// Refused, with the limit's name and value, and the connection lives on.
void expect_over(client::Client& client, const Status& status, const std::string& limit) {
  EXPECT_EQ(status.number, number(ErrorNumber::over_limit)) << status.sentence();
  EXPECT_EQ(status.text.find(limit + ": "), 0u) << status.text;
  wire::RadarList list;
  EXPECT_TRUE(client.list_radars(list).ok());
}

TEST(RequestLimits, TooManyClientsOfOneAddressAreTurnedAwayAndOthersAreNot) {
  net::ServerOptions options = small_options();
  options.max_clients_per_address = 2;
  options.max_clients = 3;
  const TestServer server(options);
  const client::Client first = connect(server);
  client::Client second = connect(server);
  client::Client third;
  const Status status = third.connect(server.endpoint());
  EXPECT_EQ(status.number, number(ErrorNumber::too_many_from_address)) << status.sentence();
  EXPECT_NE(status.text.find("max_clients_per_address is 2"), std::string::npos) << status.text;
  // Another address of this machine: Linux connects from 127.0.0.1 to any of 127.0.0.0/8, so the peer must
  // bind.
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  bind_to_loopback(fd, 0x7F000002);  // 127.0.0.2
  connect_to_loopback(fd, server.endpoint().port);
  const wire::Bytes hello = hello_bytes();
  ASSERT_EQ(::send(fd, hello.data(), hello.size(), MSG_NOSIGNAL), static_cast<ssize_t>(hello.size()));
  std::byte head[wire::kHeaderBytes];
  ASSERT_EQ(::recv(fd, head, sizeof head, MSG_WAITALL), static_cast<ssize_t>(sizeof head));
  EXPECT_EQ(static_cast<int>(head[6]), static_cast<int>(wire::MessageType::welcome));
  ::close(fd);
  // Who leaves makes room.
  second.close();
  Status again;
  do {
    again = third.connect(server.endpoint());
  } while (again.number == number(ErrorNumber::too_many_from_address));
  EXPECT_TRUE(again.ok() || again.number == number(ErrorNumber::too_many_clients)) << again.sentence();
}

/// A connection that says nothing, from another address of this machine.
class Silent {
 public:
  Silent(const TestServer& server, std::uint32_t address)
      : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    bind_to_loopback(fd_, address);
    connect_to_loopback(fd_, server.endpoint().port);
  }
  Silent(const Silent&) = delete;
  Silent& operator=(const Silent&) = delete;
  ~Silent() { ::close(fd_); }
  /// Waits for the server's end of it.
  bool closed() const {
    char byte = 0;
    return ::recv(fd_, &byte, 1, 0) <= 0;
  }
  bool still_open() const {
    char byte = 0;
    return ::recv(fd_, &byte, 1, MSG_DONTWAIT) < 0 && errno == EAGAIN;
  }

 private:
  int fd_;
};

TEST(RequestLimits, ThoseWhoHaveNotSaidHelloKeepNobodyOut) {
  net::ServerOptions options = small_options();
  options.handshake_timeout_s = 3600;
  options.max_clients = 2;
  options.max_clients_per_address = 2;
  options.max_waiting = 4;
  const TestServer server(options);
  const Silent from_elsewhere(server, 0x7F000002);
  std::vector<std::unique_ptr<Silent>> silent;
  for (int i = 0; i < 70; ++i) silent.push_back(std::make_unique<Silent>(server, INADDR_LOOPBACK));
  client::Client first = connect(server);
  const client::Client second = connect(server);
  for (int i = 0; i < 66; ++i) EXPECT_TRUE(silent[static_cast<std::size_t>(i)]->closed()) << i;
  EXPECT_TRUE(from_elsewhere.still_open()) << "the oldest of the address with most of them goes";
  EXPECT_EQ(status_of(first).clients(), 2u) << "who has not said Hello is no client";
}

TEST(RequestLimits, AddressesOfOneNetworkAreOneHost) {
  EXPECT_EQ(security::network_of("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(security::network_of("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(security::network_of("2001:db8:1:2:3:4:5:6"), security::network_of("2001:db8:1:2::1"));
  EXPECT_NE(security::network_of("2001:db8:1:2::1"), security::network_of("2001:db8:1:3::1"));
  EXPECT_EQ(security::network_of("?"), "?");
}

TEST(RequestLimits, PixelsBinsAndMemoryOfARequestHaveLimitsWithNames) {
  for (const std::string limit : {"max_bins is 639", "max_pixels is 4095", "max_memory_mb is 1"}) {
    net::ServerOptions options = small_options();
    if (limit.starts_with("max_bins")) options.max_bins = 639;
    if (limit.starts_with("max_pixels")) options.max_pixels = 4095;
    if (limit.starts_with("max_memory")) options.max_memory_mb = 1;
    const TestServer server(options);
    client::Client client = connect(server);
    wire::RenderOnce once = once_request();  // 640 bins
    once.mutable_settings()->set_pixel_columns(64);
    once.mutable_settings()->set_pixel_rows(64);
    expect_over(client, client.render_once(once), limit);
    expect_over(client, client.subscribe("main", 10), limit);
    ASSERT_TRUE(client.claim_control("main").ok());
    wire::Ack ack;
    wire::RadarSettings settings;
    settings.set_gain_db(3);
    expect_over(client, client.set_settings("main", settings, ack), limit);
  }
}

TEST(RequestLimits, AtTheLimitARequestIsServed) {
  net::ServerOptions options = small_options();
  options.max_bins = 640;
  options.max_pixels = 4096;
  options.max_work_queued = 640 + 4096;
  options.max_memory_mb = 1 << 20;
  const TestServer server(options);
  client::Client client = connect(server);
  const wire::Limits& limits = client.welcome().limits();
  EXPECT_EQ(limits.max_bins(), 640u);
  EXPECT_EQ(limits.max_pixels(), 4096u);
  EXPECT_EQ(limits.max_work_queued(), 4736u);
  EXPECT_EQ(limits.max_memory_mb(), 1u << 20);
  wire::RenderOnce once = once_request();
  once.mutable_settings()->set_pixel_columns(64);
  once.mutable_settings()->set_pixel_rows(64);
  ASSERT_TRUE(client.render_once(once).ok());
  client::FrameAssembler frames;
  EXPECT_TRUE(receive_frame(client, frames).ok());
}

TEST(RequestLimits, ASweepHasItsPlanesTimesItsRangeBinsForPixels) {
  RadarSettings settings = radar_settings(FrustumKind::oblique, {}, {10, 30}, {100, 7});
  net::ServerOptions options;
  EXPECT_EQ(net::once_cost(settings, wire::kAllPlanes, options).pixels, 700);
  settings.frustum = FrustumKind::sweep;
  EXPECT_EQ(net::once_cost(settings, wire::kAllPlanes, options).pixels, 3000);
  EXPECT_EQ(net::once_cost(settings, wire::kAllPlanes, options).work(), 3300);
}

TEST(RequestLimits, ARenderOnceMakesOneTrainWhateverItsAntennaDoes) {
  RadarSettings settings = radar_settings(FrustumKind::sweep, {}, {96, 160}, {96, 1});
  settings.mode = RadarMode::pulses;
  settings.beam.pattern = BeamPattern::gaussian;
  settings.doppler.pulses = 400;
  settings.scan_mode = ScanMode::sector;
  settings.scan_dwell_bins = 24;
  net::ServerOptions options;
  options.max_memory_mb = 1 << 20;
  options.max_bins = 100'000;
  const auto planes = wire::kPulsesPlane;
  EXPECT_EQ(net::once_cost(settings, planes, options).samples, 64'000);
  EXPECT_FALSE(net::over_limit(settings, net::once_cost(settings, planes, options), 0, options));
  const auto over = net::over_limit(settings, net::live_cost(settings, planes, options), 0, options);
  ASSERT_TRUE(over);
  EXPECT_EQ(over->field.found, "400 x 160 x 4");
  // What is in memory is the pulses and some rows, not all rows that there may be.
  settings.azimuth_bins = 512;
  settings.range_bins = 8192;
  settings.doppler.pulses = 1024;
  EXPECT_LT(net::once_cost(settings, planes, options).bytes, 8'000'000'000);
}

TEST(RequestLimits, TheMemoryOfAFrameIsItsWedgesAndWhatWaitsToBeSent) {
  RadarSettings settings;
  settings.azimuth_bins = 1000;
  settings.range_bins = 1000;
  net::ServerOptions options;
  options.render_threads = 2;
  const std::int64_t wedges = 2 * wedge_bytes(settings);  // which wedge_work_test.cpp measures
  // 8 + 8 + 4 + 1 bytes a bin, PROTOCOL.md.
  EXPECT_EQ(net::once_cost(settings, wire::kAllPlanes, options).bytes, wedges + 21'000'000);
  options.slice_bytes = 1'000'000;
  EXPECT_EQ(net::once_cost(settings, wire::kAllPlanes, options).bytes, wedges + 2'000'000);
  options.queue_frames = 2;
  EXPECT_EQ(net::live_cost(settings, wire::plane_bit(wire::Plane::power), options).bytes,
            wedges + 3 * 8'000'000);
  // Labels have 1 + 4 + 4 + 1 more to send, and sums of their own for each of the scene's materials.
  options.materials = 5;
  const auto all = static_cast<wire::PlaneSet>(wire::kAllPlanes | wire::kLabelPlanes);
  EXPECT_EQ(net::live_cost(settings, all, options).bytes, 2 * wedge_bytes(settings, 5) + 3 * 31'000'000);
  EXPECT_EQ(wedge_bytes(settings, 5), wedge_bytes(settings) + 8 * 1000 * (10 + 3 * 4 * 6));
  EXPECT_GT(resident_bytes(), 1'000'000);
}

TEST(RequestLimits, PixelsOfAWedgeCountInTheMemoryThatAViewerMayTake) {
  net::ServerOptions options = small_options();
  options.render_threads = 2;
  options.max_memory_mb = 600;
  const TestServer server(options);
  client::Client client = connect(server);
  wire::RenderOnce once = once_request();
  wire::RadarSettings& settings = *once.mutable_settings();
  settings.set_speckle(wire::GROUND_SPECKLE);
  settings.set_frustum(wire::OBLIQUE);
  settings.set_azimuth_bins(8);
  settings.set_range_bins(8192);
  settings.set_pixel_columns(16384);
  settings.set_pixel_rows(16384);
  expect_over(client, client.render_once(once), "max_memory_mb is 600");
  settings.set_pixel_columns(64);
  settings.set_pixel_rows(64);
  EXPECT_TRUE(client.render_once(once).ok()) << "as many bins, and few pixels";
}

TEST_F(Served, TheWeightsOfABeamsPlanHaveALimitThatIsLookedAtBeforeItIsMade) {
  wire::RenderOnce once = once_request();
  wire::RadarSettings& settings = *once.mutable_settings();
  settings.set_frustum(wire::SWEEP);
  settings.set_sector_deg(360);
  settings.set_azimuth_bins(8192);
  settings.set_range_bins(8192);
  settings.set_r_min_m(4000);
  settings.set_r_max_m(20'000);
  settings.set_beam_pattern(wire::TAYLOR_BEAM);
  settings.set_beam_width_deg(0.05);
  settings.set_beam_extent_deg(180);
  settings.set_pulse_kind(wire::RECTANGULAR_PULSE);
  settings.set_pulse_length_us(0.00163);  // an eighth of a range bin
  settings.set_pulse_extent_bins(1);
  const Status status = client.render_once(once);
  expect_over(client, status, "max_plan_taps is 20000000");
  // 16,384 of each azimuth for each of 4,096 tiles, and those of the pulse's ends.
  EXPECT_NE(status.text.find("the plan of the beam has 671"), std::string::npos) << status.text;
  EXPECT_NE(status.sentence().find("beam.extent_deg"), std::string::npos) << status.sentence();
  EXPECT_LT(peak_resident_bytes(), 400'000'000) << "one plan alone takes 537 MB";
  settings.set_beam_extent_deg(0);
  EXPECT_TRUE(client.render_once(once).ok()) << "as many bins, and a narrow beam";
}

TEST(RequestLimits, OfMemoryAreThreeQuartersOfWhatThereIsUnlessTheOperatorSaysOtherwise) {
  const double there_is_mb = 1e-6 * static_cast<double>(memory_there_is_bytes());
  net::ServerOptions options = small_options();
  EXPECT_EQ(options.max_memory_mb, 0);
  {
    const TestServer server(options);
    client::Client client = connect(server);
    EXPECT_NEAR(static_cast<double>(client.welcome().limits().max_memory_mb()), 0.75 * there_is_mb, 1);
    // One wedge of all pixels, whose scatterers take 200 GB.
    wire::RenderOnce once = once_request();
    wire::RadarSettings& settings = *once.mutable_settings();
    settings.set_speckle(wire::GROUND_SPECKLE);
    settings.set_frustum(wire::SWEEP);
    settings.set_azimuth_bins(1);
    settings.set_range_bins(8192);
    settings.set_sub_columns(0);  // exact planes, all at once
    settings.set_pixel_columns(16384);
    expect_over(client, client.render_once(once),
                "max_memory_mb is " + std::to_string(client.welcome().limits().max_memory_mb()));
  }
  options.max_memory_mb = std::numeric_limits<double>::infinity();
  const TestServer server(options);
  EXPECT_EQ(connect(server).welcome().limits().max_memory_mb(), 0u) << "no limit";
}

TEST(RequestLimits, WorkThatWaitsIsCountedOverAllClients) {
  Gate gate;
  gate.close();
  net::ServerOptions options = small_options();
  options.max_work_queued = 2 * (640 + 4096);
  PatternRenderer renderer;
  renderer.before_wedge = [&](int) { gate.pass(); };
  const TestServer server(renderer, options);
  client::Client first = connect(server);
  client::Client second = connect(server);
  wire::RenderOnce once = once_request();
  once.mutable_settings()->set_pixel_columns(64);
  once.mutable_settings()->set_pixel_rows(64);
  client::FrameAssembler frames;
  second.set_handler(&frames);  // its frame may begin before the gate, while it waits for an answer
  ASSERT_TRUE(first.render_once(once).ok());
  ASSERT_TRUE(second.render_once(once).ok());
  const Status status = second.render_once(once);
  expect_over(second, status, "max_work_queued is 9472");
  EXPECT_NE(status.text.find("9472 of all clients wait already"), std::string::npos) << status.text;
  gate.open();
  EXPECT_TRUE(receive_frame(second, frames).ok());
  frames.take();
  // Its place is free once its frame is on its way.
  Status again;
  do {
    again = second.render_once(once);
  } while (again.number == number(ErrorNumber::over_limit));
  EXPECT_TRUE(again.ok()) << again.sentence();
}

TEST(RequestLimits, AMessageAByteAtATimeHasTheTimeOfOneMessageNotOfOneByte) {
  const TestServer server;  // 0.3 s
  RawPeer peer(server);
  peer.send(hello_bytes());
  wire::Welcome welcome;
  ASSERT_TRUE(peer.await(wire::MessageType::welcome, welcome));
  wire::GetRadar request;
  request.set_radar(std::string(100000, 'x'));  // at this pace a quarter of an hour
  const wire::Bytes bytes = wire::encode_message(wire::MessageType::get_radar, {0, 2, 0}, request);
  bool ended = false;
  for (std::size_t i = 0; i < 2000 && !ended; ++i) {
    ended = !peer.socket().send(std::span(bytes).subspan(i, 1), kLong).ok() ||
            peer.socket().wait_readable(client::Timeout(10)).ok();
  }
  EXPECT_TRUE(ended);
}

TEST(RequestLimits, BeforeHelloAMessageHasAtMost4096Bytes) {
  const TestServer server;
  wire::Hello hello;
  hello.set_major(wire::kMajorVersion);
  hello.set_token(std::string(4000, 'x'));
  RawPeer allowed(server);
  allowed.send(wire::encode_message(wire::MessageType::hello, {}, hello));
  wire::Welcome welcome;
  EXPECT_TRUE(allowed.await(wire::MessageType::welcome, welcome));
  hello.set_token(std::string(4096, 'x'));
  RawPeer peer(server);
  peer.send(wire::encode_message(wire::MessageType::hello, {}, hello));
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::bad_length));
}

TEST(RequestLimits, AMessageLongerThanAllowedIsRefused) {
  net::ServerOptions options = small_options();
  options.max_request_bytes = 1024;
  const TestServer server(options);
  RawPeer peer(server);
  peer.send(hello_bytes());
  wire::GetRadar request;
  request.set_radar(std::string(2000, 'x'));
  peer.send(wire::encode_message(wire::MessageType::get_radar, {}, request));
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::bad_length));
}

}  // namespace
}  // namespace obliq::test::limits_test
