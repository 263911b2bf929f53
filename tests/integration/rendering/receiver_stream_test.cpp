// Noise and video on the wire: a live frame again by its number, 8 and 16 bits, what video alone needs.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/radar/beam/pattern_cuts.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/render.h"
#include "server/rendering/demand.h"
#include "server/rendering/frame_cache.h"
#include "server/rendering/scene_renderer.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::test::receiver_stream_test {
namespace {

using client::FrameAssembler;
using wire::Plane;

RadarConfig noisy_radar() {
  RadarConfig radar;
  radar.name = "main";
  radar.settings = small_frame(FrustumKind::sweep);
  radar.settings.power_w = 50e3;
  radar.settings.gain_db = 30;
  radar.settings.receiver.noise = true;
  radar.settings.receiver.gain_db = 6;
  radar.settings.atmosphere.rain_mm_h = 20;
  radar.pose = settings_over_origin(1400, 0);
  auto table = std::make_shared<PatternCuts>();
  table->azimuth = {{-0.2, 0, 0.2}, {-30, 0, -30}};
  radar.settings.beam.file = table;  // and no pattern that takes it
  return radar;
}

class ReceiverStream : public testing::Test {
 protected:
  ReceiverStream() : scene_(make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)))) {
    renderer_.emplace(scene_, "hills");
    cache_.emplace(*renderer_);
    server_.emplace(*cache_, std::vector<RadarConfig>{radar_}, small_options());
    thread_ = std::thread([this] { server_->run(); });
    EXPECT_TRUE(is_ok(client_.connect({"127.0.0.1", server_->port()}, {.name = "tester"})));
  }
  ~ReceiverStream() override {
    server_->stop();
    thread_.join();
  }

  client::AssembledFrame next_frame(FrameAssembler& frames) {
    EXPECT_TRUE(is_ok(receive_frame(client_, frames)));
    return frames.take();
  }
  /// The frame of that number again.
  client::AssembledFrame once(const client::AssembledFrame& like, wire::PlaneSet planes, std::uint32_t bits) {
    wire::RenderOnce request;
    request.set_radar("main");
    *request.mutable_settings() = like.descriptor->settings();
    request.mutable_settings()->set_noise_frame(like.descriptor->noise_counter());
    *request.mutable_pose() = like.descriptor->pose();
    for (int plane = 0; plane < wire::kPlanes; ++plane)
      if ((planes >> plane) & 1) request.add_planes(static_cast<wire::PlaneKind>(plane));
    request.set_video_bits(bits);
    request.set_compression(wire::ZSTD);
    EXPECT_TRUE(client_.render_once(request).ok());
    FrameAssembler frames(planes);
    client::AssembledFrame frame = next_frame(frames);
    EXPECT_EQ(frame.request_id, request.request_id());
    return frame;
  }
  wire::Subscribe subscription(wire::PlaneSet planes) {
    wire::Subscribe request;
    request.set_radar("main");
    request.set_rate_hz(100);
    for (int plane = 0; plane < wire::kPlanes; ++plane)
      if ((planes >> plane) & 1) request.add_planes(static_cast<wire::PlaneKind>(plane));
    return request;
  }

  const RadarConfig radar_ = noisy_radar();
  std::shared_ptr<const Scene> scene_;
  std::optional<rendering::SceneRenderer> renderer_;
  std::optional<rendering::FrameCache> cache_;
  std::optional<net::Server> server_;
  std::thread thread_;
  client::Client client_;
};

constexpr wire::PlaneSet kEvery = wire::kBinPlanes;

TEST_F(ReceiverStream, EachLiveFrameHasItsOwnNoiseAndCanBeHadAgain) {
  wire::Subscribe request = subscription(kEvery);
  ASSERT_TRUE(client_.subscribe(request).ok());
  FrameAssembler frames(kEvery);
  std::vector<client::AssembledFrame> live;
  // The first is rendered, the second kept as well, the third made of what is kept.
  while (live.size() < 4) live.push_back(next_frame(frames));
  ASSERT_TRUE(client_.unsubscribe("main").ok());
  for (std::size_t k = 0; k < live.size(); ++k) {
    EXPECT_EQ(live[k].descriptor->noise_counter(), live[k].descriptor->frame_id());
    EXPECT_GT(live[k].descriptor->noise_power_w(), 0);
    EXPECT_TRUE(same_bits(live[k].power_w, live[0].power_w)) << k;
    EXPECT_TRUE(same_bits(live[k].height_m, live[0].height_m)) << "labels have no noise: " << k;
    EXPECT_EQ(same_bits(live[k].iq, live[0].iq), k == 0) << k;
    const client::AssembledFrame again = once(live[k], kEvery, 8);
    EXPECT_TRUE(same_bits(again.iq, live[k].iq)) << k;
    EXPECT_TRUE(same_bits(again.power_w, live[k].power_w)) << k;
    EXPECT_TRUE(same_bits(again.video, live[k].video)) << k;
    EXPECT_TRUE(same_bits(again.material, live[k].material)) << k;
    EXPECT_TRUE(same_bits(again.building, live[k].building)) << k;
    EXPECT_TRUE(same_bits(again.height_m, live[k].height_m)) << k;
    EXPECT_TRUE(same_bits(again.returns, live[k].returns)) << k;
    EXPECT_EQ(again.video_bits, 8);
  }
}

TEST_F(ReceiverStream, AFrameHasTheBitsOfObliqRender) {
  RadarSettings settings = radar_.settings;
  settings.receiver.noise_frame = 17;
  wire::RadarInfo info;
  ASSERT_TRUE(client_.get_radar("main", info).ok());
  client::AssembledFrame like;
  like.descriptor = std::make_unique<wire::FrameDescriptor>();
  *like.descriptor->mutable_settings() = info.settings();
  *like.descriptor->mutable_pose() = info.pose();
  like.descriptor->set_noise_counter(17);
  const client::AssembledFrame sent = once(like, kEvery, 16);
  const PlanResult planned = plan_frame(scene_, snapshot(settings), pose_over_origin(scene_->world(), 1400));
  ASSERT_TRUE(planned.plan);
  const Receiver receiver(settings, "main", 17, air_view(planned.plan->looks_at()));
  BinBlock bins(0, settings.azimuth_bins, settings.range_bins);
  RenderOptions options;
  options.threads = 2;
  options.receiver = &receiver;
  options.video16 = true;
  options.on_wedge = [&](Wedge&& wedge) { copy_azimuths(wedge.bins, bins); };
  ASSERT_TRUE(render_wedges(*planned.plan, {0, settings.azimuth_bins}, options));
  EXPECT_TRUE(same_bits(sent.iq, bins.iq));
  EXPECT_TRUE(same_bits(sent.power_w, bins.power_w));
  EXPECT_TRUE(same_bits(sent.state, bins.state));
  EXPECT_TRUE(same_bits(sent.video, bins.video16));
}

TEST_F(ReceiverStream, VideoComesOnlyByNameAndFollowsFromIq) {
  wire::Subscribe request = subscription(0);
  ASSERT_TRUE(client_.subscribe(request).ok());
  FrameAssembler frames(wire::kAllPlanes);
  const client::AssembledFrame frame = next_frame(frames);
  ASSERT_TRUE(client_.unsubscribe("main").ok());
  EXPECT_TRUE(frame.video.empty());
  const client::AssembledFrame shown = once(frame, wire::plane_bit(Plane::video), 16);
  EXPECT_TRUE(shown.iq.empty());
  ASSERT_EQ(shown.video.size(), frame.iq.size());
  EXPECT_EQ(shown.video_bits, 16);
  const double floor_db = shown.descriptor->video_floor_db();
  for (std::size_t k = 0; k < frame.iq.size(); ++k) {
    const double x = 10 * std::log10(std::norm(std::complex<double>(frame.iq[k])));
    const double level = std::clamp(1 + std::round(65534 * (x - floor_db) / 100), 1.0, 65535.0);
    ASSERT_NEAR(shown.video[k], level, 1) << k;
  }
}

TEST_F(ReceiverStream, VideoOfSeveralLooksNeedsNoIq) {
  wire::RadarInfo info;
  ASSERT_TRUE(client_.get_radar("main", info).ok());
  client::AssembledFrame like;
  like.descriptor = std::make_unique<wire::FrameDescriptor>();
  *like.descriptor->mutable_settings() = info.settings();
  like.descriptor->mutable_settings()->set_video_looks(100);
  *like.descriptor->mutable_pose() = info.pose();
  const client::AssembledFrame alone = once(like, wire::plane_bit(Plane::video), 8);
  const client::AssembledFrame beside = once(like, kEvery, 8);
  EXPECT_TRUE(same_bits(alone.video, beside.video));
  RadarSettings settings = radar_.settings;
  settings.video.looks = 100;
  const stream::StreamChoice video{.planes = wire::plane_bit(Plane::video)};
  EXPECT_FALSE(rendering::needed_planes(video, settings).iq);
  settings.video.looks = 1;
  EXPECT_TRUE(rendering::needed_planes(video, settings).iq);
}

TEST_F(ReceiverStream, ATableOfThePatternServesAFrameThatIsAskedFor) {
  wire::RenderOnce request;
  request.set_radar("main");
  request.mutable_settings()->set_beam_pattern(wire::FILE_BEAM);
  write_message(radar_.pose, *request.mutable_pose());
  EXPECT_TRUE(client_.render_once(request).ok());
  request.set_radar("another");
  EXPECT_FALSE(client_.render_once(request).ok()) << "it has no table";
}

TEST_F(ReceiverStream, WhatNoFrameCouldComeOfIsRefusedAtOnce) {
  ASSERT_TRUE(client_.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_beam_pattern(wire::GAUSSIAN_BEAM);
  settings.set_beam_width_deg(30);
  settings.set_sector_deg(331.7);
  wire::Ack ack;
  const client::Status closed = client_.set_settings("main", settings, ack);
  ASSERT_EQ(closed.fields.size(), 1u) << closed.sentence();
  EXPECT_EQ(closed.fields[0].field, "bins.azimuth");
  settings.set_sector_deg(90);
  settings.set_beam_elevation(wire::COSECANT_ELEVATION);
  ASSERT_TRUE(client_.set_settings("main", settings, ack).ok());
  wire::Pose pose;
  pose.set_tilt_deg(20);
  const client::Status up = client_.set_pose("main", pose, ack);
  ASSERT_EQ(up.fields.size(), 1u) << up.sentence();
  EXPECT_EQ(up.fields[0].field, "antenna.tilt_deg");
  pose.set_tilt_deg(-2);
  EXPECT_TRUE(client_.set_pose("main", pose, ack).ok());
}

TEST_F(ReceiverStream, OtherBitsAreRefused) {
  wire::Subscribe request = subscription(wire::plane_bit(Plane::video));
  request.set_video_bits(12);
  const client::Status status = client_.subscribe(request);
  ASSERT_EQ(status.fields.size(), 1u);
  EXPECT_EQ(status.fields[0].field, "video_bits");
  EXPECT_EQ(status.fields[0].found, "12");
  EXPECT_EQ(status.fields[0].allowed, "8 or 16; 0 is 8");
}

}  // namespace
}  // namespace obliq::test::receiver_stream_test
