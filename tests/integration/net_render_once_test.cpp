// Frames for one client alone: RenderOnce.
#include <gtest/gtest.h>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test {
namespace {

using client::FrameAssembler;
using client::Outcome;
using wire::ErrorNumber;

TEST(RenderOnce, RenderOnceGivesItsOwnFrameAndTouchesNoRadar) {
  const TestServer server;
  client::Client client = connect(server);
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

TEST(RenderOnce, RenderOnceNeedsAnAntennaAndValidSettings) {
  const TestServer server;
  client::Client client = connect(server);
  wire::RenderOnce request = once_request();
  request.clear_pose();
  request.mutable_settings()->set_azimuth_bins(0);
  const client::Status status = client.render_once(request);
  EXPECT_EQ(status.number, number(ErrorNumber::invalid_value));
  EXPECT_EQ(status.fields.size(), 4u) << status.sentence();
}

TEST(RenderOnce, RenderOnceThatTheSceneForbidsIsAnsweredByAnError) {
  const TestServer server;
  client::Client client = connect(server);
  wire::RenderOnce request = once_request();
  request.mutable_pose()->set_height_m(5);
  ASSERT_TRUE(client.render_once(request).ok()) << "queued: only the planning finds out";
  const client::Status status = client.receive(kLong);
  EXPECT_EQ(status.outcome, Outcome::refused);
  ASSERT_EQ(status.fields.size(), 1u);
  EXPECT_EQ(status.fields[0].field, "frustum.kind");
  wire::RenderOnce good = once_request();
  ASSERT_TRUE(client.render_once(good).ok()) << "the failed one no longer counts";
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

TEST(RenderOnce, ALargerFrameThanAllowedIsRefused) {
  net::ServerOptions options = small_options();
  options.max_bins = 639;
  const TestServer server(options);
  client::Client client = connect(server);
  wire::RenderOnce request = once_request();
  const client::Status status = client.render_once(request);
  EXPECT_EQ(status.number, number(ErrorNumber::over_limit));
  EXPECT_EQ(status.text, "max_bins is 639: the frame has 640");
  EXPECT_NE(status.sentence().find("at most 639 bins"), std::string::npos) << status.sentence();
}

}  // namespace
}  // namespace obliq::test
