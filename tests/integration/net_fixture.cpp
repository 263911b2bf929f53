#include "tests/integration/net_fixture.h"

#include <gtest/gtest.h>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"

namespace obliq::test {
namespace {

class PatternFrame : public rendering::PlannedFrame {
 public:
  PatternFrame(SettingsPtr settings, const PoseSettings& pose, const std::function<void(int)>& before_wedge)
      : settings_(std::move(settings)), pose_(pose), before_wedge_(before_wedge) {}

  void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const override {
    descriptor.set_radar(radar);
    descriptor.set_settings_version(settings_->version);
    write_message(settings_->settings, *descriptor.mutable_settings());
    write_message(pose_, *descriptor.mutable_pose());
  }

  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    const RadarSettings& settings = settings_->settings;
    for (int first = azimuths.first; first < azimuths.first + azimuths.count; first += kWedgeAzimuthBins) {
      if (options.stop.stop_requested()) return false;
      Wedge wedge;
      wedge.index = first / kWedgeAzimuthBins;
      if (before_wedge_) before_wedge_(wedge.index);
      wedge.bins =
          BinBlock(first, std::min(kWedgeAzimuthBins, settings.azimuth_bins - first), settings.range_bins);
      for (int a = 0; a < wedge.bins.n_azimuth; ++a) {
        for (int r = 0; r < settings.range_bins; ++r) {
          const auto at = static_cast<std::size_t>(a * settings.range_bins + r);
          const double power = pattern_power(settings, pose_, first + a, r);
          wedge.bins.power_w[at] = power;
          wedge.bins.iq[at] = {static_cast<float>(power), static_cast<float>(-r)};
          wedge.bins.count[at] = static_cast<std::uint32_t>(first + a);
          wedge.bins.state[at] = static_cast<std::uint8_t>(r % 4);
        }
      }
      wedge.bins.video8.assign(wedge.bins.state.size(), 100);
      wedge.stats.samples = 1;
      options.on_wedge(std::move(wedge));
    }
    return !options.stop.stop_requested();
  }

  void summarise(const FrameStats& stats, wire::FrameSummary& summary) const override {
    summary.set_samples(stats.samples);
  }

 private:
  SettingsPtr settings_;
  PoseSettings pose_;
  const std::function<void(int)>& before_wedge_;
};

}  // namespace

double pattern_power(const RadarSettings& settings, const PoseSettings& pose, int azimuth, int range) {
  return settings.r_max_m * 1e6 + pose.bearing_deg * 1e5 + azimuth * 1000.0 + range;
}

double pattern_power(const client::AssembledFrame& frame, int azimuth, int range) {
  RadarSettings settings;
  settings.r_max_m = frame.descriptor->settings().r_max_m();
  PoseSettings pose;
  pose.bearing_deg = frame.descriptor->pose().bearing_deg();
  return pattern_power(settings, pose, azimuth, range);
}

std::vector<FieldError> PatternRenderer::place(const PoseSettings& pose) const {
  if (pose.height_m >= 0) return {};
  return {{"height_m", std::to_string(pose.height_m), "above the ground"}};
}

std::vector<FieldError> PatternRenderer::scene_faults(const RadarSettings& settings) const {
  if (settings.gain_db != kGainOverPlates_db || settings.frustum != FrustumKind::sweep) return {};
  return {{"frustum.kind", "\"sweep\" with flat plates (steel)", "\"oblique\""}};
}

rendering::FrameRenderer::Plan PatternRenderer::plan(const SettingsPtr& settings,
                                                     const PoseSettings& pose) const {
  Plan plan;
  // Stands for what only the scene can tell, such as an oblique frustum below the terrain top.
  if (settings->settings.frustum == FrustumKind::oblique && pose.height_m < 10) {
    plan.errors.push_back({"frustum.kind", "oblique", "sweep, for an antenna so low"});
    return plan;
  }
  plan.frame = std::make_unique<PatternFrame>(settings, pose, before_wedge);
  return plan;
}

net::ServerOptions small_options() {
  net::ServerOptions options;
  options.port = 0;
  options.server_name = "test server";
  options.handshake_timeout_s = 0.3;
  options.message_timeout_s = 0.3;
  options.stop_limit_s = 0.6;
  options.stop_grace_s = 0.3;
  options.render_threads = 1;
  return options;
}

RadarConfig small_radar(const std::string& name) {
  RadarConfig radar;
  radar.name = name;
  radar.settings.azimuth_bins = 20;  // two whole wedges and a half one
  radar.settings.range_bins = 32;
  radar.settings.pixel_columns = 64;
  radar.settings.pixel_rows = 64;
  radar.pose.bearing_deg = radar.pose.heading_deg = 45;
  return radar;
}

TestServer::TestServer(net::ServerOptions options) : TestServer(renderer_, std::move(options)) {}

TestServer::TestServer(const rendering::FrameRenderer& renderer, net::ServerOptions options)
    : server_(renderer, {small_radar("main"), small_radar("nose")}, std::move(options)),
      thread_([this] { server_.run(); }) {}

TestServer::~TestServer() { stop(); }

void TestServer::stop() {
  if (!thread_.joinable()) return;
  server_.stop();
  thread_.join();
}

client::Client connect(const TestServer& server, const std::string& name) {
  client::Client made;
  EXPECT_TRUE(is_ok(made.connect(server.endpoint(), {.name = name})));
  return made;
}

client::Status receive_frame(client::Client& client, client::FrameAssembler& frames) {
  client.set_handler(&frames);
  while (frames.state() != client::FrameAssembler::State::complete) {
    if (client::Status status = client.receive(kLong); !status.ok()) return status;
    if (frames.state() == client::FrameAssembler::State::aborted) {
      return client::Status::failure(client::Outcome::aborted, frames.abort_reason());
    }
  }
  return {};
}

RawPeer::RawPeer(const TestServer& server) {
  EXPECT_TRUE(is_ok(client::Socket::connect(server.endpoint(), kLong, socket_)));
}

void RawPeer::send(std::span<const std::byte> bytes) {
  // The server may have closed already; what it said counts.
  (void)socket_.send(bytes, kLong).ok();
}
void RawPeer::send(std::string_view text) { send(std::as_bytes(std::span(text.data(), text.size()))); }

bool RawPeer::await(wire::MessageType type, google::protobuf::MessageLite& message) {
  wire::Bytes received;
  std::byte one{};
  while (socket_.receive(std::span(&one, 1), kLong).ok()) {
    received.push_back(one);
    wire::MessageView view;
    if (wire::decode_message(received, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok) continue;
    if (view.header.type == type) return wire::parse_descriptor(view.descriptor, message);
    received.clear();
  }
  return false;
}

std::uint32_t RawPeer::error_number() {
  wire::Error error;
  std::uint32_t number = 0;
  while (await(wire::MessageType::error, error)) number = error.number();
  return number;
}

void expect_pattern(const client::AssembledFrame& frame) {
  ASSERT_EQ(frame.power_w.size(), static_cast<std::size_t>(frame.n_azimuth * frame.n_range));
  for (int a = 0; a < frame.n_azimuth; ++a) {
    for (int r = 0; r < frame.n_range; ++r) {
      const auto at = static_cast<std::size_t>(a * frame.n_range + r);
      ASSERT_EQ(frame.power_w[at], pattern_power(frame, a, r)) << a << ", " << r;
      ASSERT_EQ(frame.iq[at].imag(), static_cast<float>(-r));
      ASSERT_EQ(frame.count[at], static_cast<std::uint32_t>(a));
      ASSERT_EQ(frame.state[at], r % 4);
    }
  }
}

wire::RenderOnce once_request() {
  wire::RenderOnce request;
  request.set_radar("main");
  request.mutable_settings()->set_azimuth_bins(20);
  request.mutable_settings()->set_range_bins(32);
  request.mutable_pose()->set_latitude_deg(33);
  request.mutable_pose()->set_longitude_deg(-99);
  request.mutable_pose()->set_height_m(1000);
  return request;
}

wire::RenderOnce large_once_request() {
  wire::RenderOnce request = once_request();
  request.mutable_settings()->set_azimuth_bins(2000);
  request.mutable_settings()->set_range_bins(2000);
  return request;
}

wire::Subscribe request_at(double rate_hz) {
  wire::Subscribe request;
  request.set_radar("main");
  request.set_rate_hz(rate_hz);
  return request;
}

void size_radar(client::Client& client, std::uint32_t azimuth_bins, std::uint32_t range_bins) {
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_azimuth_bins(static_cast<std::int32_t>(azimuth_bins));
  settings.set_range_bins(static_cast<std::int32_t>(range_bins));
  wire::Ack ack;
  ASSERT_TRUE(is_ok(client.set_settings("main", settings, ack)));
}

wire::Status status_of(client::Client& client) {
  wire::Status status;
  EXPECT_TRUE(is_ok(client.get_status(status)));
  return status;
}

wire::Pose moved() {
  wire::Pose pose;
  pose.set_latitude_deg(0.5);
  return pose;
}

wire::Pose tilted(double tilt_deg) {
  wire::Pose pose;
  pose.set_tilt_deg(tilt_deg);
  return pose;
}

wire::RadarInfo info_of(client::Client& client) {
  wire::RadarInfo info;
  EXPECT_TRUE(is_ok(client.get_radar("main", info)));
  return info;
}

wire::Bytes hello_bytes() {
  wire::Hello hello;
  hello.set_request_id(1);
  hello.set_major(wire::kMajorVersion);
  hello.set_client_name("raw");
  return wire::encode_message(wire::MessageType::hello, {0, 1, wire::utc_now_ns()}, hello);
}

}  // namespace obliq::test
