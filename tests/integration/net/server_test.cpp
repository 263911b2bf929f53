// What well-behaved clients get from a server, several at a time.
#include <gtest/gtest.h>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::server_test {
namespace {

using client::FrameAssembler;
using client::Outcome;
using wire::ErrorNumber;

TEST(Server, ServesAClientOfVersion1Point0) {
  const TestServer server;
  const wire::Bytes now = hello_bytes();
  wire::HeaderBytes head{};
  std::copy_n(now.begin(), wire::kHeaderBytes, head.begin());
  wire::MessageHeader header;
  ASSERT_EQ(wire::decode_header(head, wire::kMaxPayloadBytes, header), wire::HeaderStatus::ok);
  header.minor = 0;
  wire::encode_header(header, head);
  const auto payload = std::span(now).subspan(wire::kHeaderBytes);
  header.crc = wire::message_crc(head, payload);
  wire::encode_header(header, head);
  RawPeer peer(server);
  peer.send(head);
  peer.send(payload);
  wire::Welcome welcome;
  ASSERT_TRUE(peer.await(wire::MessageType::welcome, welcome));
  EXPECT_EQ(welcome.major(), 1u);
  EXPECT_EQ(welcome.minor(), 2u) << "PROTOCOL.md, Versions";
}

TEST_F(Served, RefusesAnUnknownRadarAndNamesThoseThereAre) {
  wire::RadarInfo info;
  const client::Status status = client.get_radar("tail", info);
  EXPECT_EQ(status.number, number(ErrorNumber::unknown_radar));
  ASSERT_EQ(status.fields.size(), 1u);
  EXPECT_EQ(status.fields[0].found, "tail");
  EXPECT_EQ(status.fields[0].allowed, "main, nose");
}

TEST(Server, StreamsWholeFramesToSeveralClientsAtOnce) {
  const TestServer server;
  client::Client first = connect(server);
  client::Client second = connect(server);
  ASSERT_TRUE(first.subscribe("main", 50).ok());
  ASSERT_TRUE(second.subscribe("nose", 50).ok());
  for (int i = 0; i < 3; ++i) {
    FrameAssembler frames;
    ASSERT_TRUE(is_ok(receive_frame(first, frames)));
    EXPECT_EQ(frames.frame().descriptor->radar(), "main");
    EXPECT_EQ(frames.frame().summary->samples(), 3u) << "one per wedge of the pattern";
    expect_pattern(frames.frame());
  }
  FrameAssembler frames;
  ASSERT_TRUE(receive_frame(second, frames).ok());
  EXPECT_EQ(frames.frame().descriptor->radar(), "nose");
  expect_pattern(frames.frame());
}

TEST_F(Served, RefusesFrustaThatCannotLookOfSettingsAndOfSingleFrames) {
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings polar, speckle, plates;
  polar.set_frustum(wire::POLAR);  // of recordings alone
  for (wire::RadarSettings* sweep : {&speckle, &plates}) sweep->set_frustum(wire::SWEEP);
  speckle.set_speckle(wire::GEOMETRIC_SPECKLE);
  plates.set_gain_db(kGainOverPlates_db);
  for (const auto& [settings, field] :
       {std::pair{polar, "frustum.kind"}, {speckle, "radar.speckle"}, {plates, "frustum.kind"}}) {
    wire::Ack ack;
    wire::RenderOnce once;
    *once.mutable_settings() = settings;
    once.mutable_pose()->set_latitude_deg(33);
    once.mutable_pose()->set_longitude_deg(-99.5);
    once.mutable_pose()->set_height_m(500);
    for (const client::Status& status :
         {client.set_settings("main", settings, ack), client.render_once(once)}) {
      EXPECT_EQ(status.number, number(ErrorNumber::invalid_value)) << status.sentence();
      ASSERT_EQ(status.fields.size(), 1u) << status.sentence();
      EXPECT_EQ(status.fields[0].field, field);
    }
  }
  wire::Ack ack;
  plates.set_frustum(wire::OBLIQUE);
  EXPECT_TRUE(client.set_settings("main", plates, ack).ok()) << "rays can";
}

TEST(Server, SendsWedgesAsTheyAreFinished) {
  constexpr int kLastWedge = 2;
  Gate gate;
  gate.close();
  PatternRenderer renderer;
  renderer.before_wedge = [&](int wedge) {
    if (wedge == kLastWedge) gate.pass();
  };
  const TestServer server(renderer, small_options());
  client::Client client = connect(server);
  FrameAssembler frames;
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  // 16 of 20 azimuth bins can arrive while the last wedge has not been rendered.
  while (frames.fraction() < 0.79) {
    ASSERT_TRUE(is_ok(client.receive(kLong)));
  }
  EXPECT_EQ(frames.state(), FrameAssembler::State::receiving);
  EXPECT_EQ(frames.frame().power_w[5], pattern_power(small_radar("").settings, small_radar("").pose, 0, 5));
  gate.open();
  ASSERT_TRUE(receive_frame(client, frames).ok());
  expect_pattern(frames.frame());
}

TEST(Server, ARadarHasOneControllerWhoIsNamedToOthers) {
  const TestServer server;
  client::Client pilot = connect(server, "pilot");
  client::Client other = connect(server, "other");
  wire::Ack ack;
  wire::Pose pose;
  pose.set_bearing_deg(10);
  EXPECT_EQ(pilot.set_pose("main", pose, ack).number, number(ErrorNumber::not_in_control));
  EXPECT_EQ(pilot.set_state("main", false, {}).number, number(ErrorNumber::not_in_control));
  ASSERT_TRUE(pilot.claim_control("main").ok());
  ASSERT_TRUE(pilot.claim_control("main").ok()) << "claiming twice is harmless";
  for (const client::Status& refused :
       {other.claim_control("main"), other.set_pose("main", pose, ack), other.set_settings("main", {}, ack),
        other.release_control("main"), other.set_state("main", false, true)}) {
    EXPECT_EQ(refused.number, number(ErrorNumber::controlled_by_other));
    EXPECT_NE(refused.text.find("pilot (127.0.0.1:"), std::string::npos) << refused.text;
  }
  EXPECT_TRUE(other.claim_control("nose").ok()) << "another radar is another matter";
  EXPECT_TRUE(pilot.set_pose("main", pose, ack).ok());
  ASSERT_TRUE(pilot.release_control("main").ok());
  EXPECT_TRUE(other.claim_control("main").ok());
}

TEST(Server, ControlIsReleasedWhenItsHolderLeaves) {
  const TestServer server;
  client::Client pilot = connect(server, "pilot");
  client::Client other = connect(server, "other");
  ASSERT_TRUE(pilot.claim_control("main").ok());
  pilot.close();
  client::Status status;
  do {  // the server notices in its own time
    status = other.claim_control("main");
  } while (status.number == number(ErrorNumber::controlled_by_other));
  EXPECT_TRUE(status.ok()) << status.sentence();
}

TEST_F(Served, NewSettingsAndPoseShowInTheNextFramesAndVersion) {
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_r_max_m(50000);
  wire::Ack ack;
  ASSERT_TRUE(client.set_settings("main", settings, ack).ok());
  EXPECT_EQ(ack.settings_version(), 2u);
  wire::Pose pose;
  pose.set_bearing_deg(90);
  pose.set_pose_id(42);
  pose.set_sim_time_ns(-5);
  ASSERT_TRUE(client.set_pose("main", pose, ack).ok());

  /// Keeps the echo of the newest block.
  struct Echo : FrameAssembler {
    wire::WedgeBlock block;
    client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& newest,
                            std::span<const std::byte> values) override {
      block = newest;
      return FrameAssembler::on_block(header, newest, values);
    }
  } frames;
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  ASSERT_TRUE(receive_frame(client, frames).ok());
  EXPECT_EQ(frames.frame().descriptor->settings().r_max_m(), 50000);
  EXPECT_EQ(frames.frame().descriptor->settings().r_min_m(), 3700) << "absent fields keep their value";
  expect_pattern(frames.frame());
  EXPECT_EQ(frames.block.pose().pose_id(), 42u);
  EXPECT_EQ(frames.block.pose().sim_time_ns(), -5);
  EXPECT_EQ(frames.block.settings_version(), 2u);
  EXPECT_GT(frames.block.pose_received_ns(), 0);
  EXPECT_GE(frames.block.render_start_ns(), frames.block.pose_received_ns());
  EXPECT_GE(frames.block.send_ns(), frames.block.render_start_ns());
}

TEST_F(Served, SentPosesArriveInTheirOrderAndRefusalsComeToTheHandler) {
  struct Refusals : client::FrameHandler {
    std::vector<client::Status> all;
    client::Status on_refused_pose(const client::Status& why) override {
      all.push_back(why);
      return {};
    }
  } refusals;
  client.set_handler(&refusals);
  wire::Pose pose;
  ASSERT_TRUE(client.send_pose("main", pose).ok());
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  ASSERT_EQ(refusals.all.size(), 1u);
  EXPECT_EQ(refusals.all[0].number, number(ErrorNumber::not_in_control));
  ASSERT_TRUE(client.claim_control("main").ok());
  constexpr int kPoses = 2000;
  for (int k = 0; k < kPoses; ++k) {
    pose.set_pose_id(static_cast<std::uint64_t>(k));
    pose.set_bearing_deg(k % 360);
    ASSERT_TRUE(client.send_pose("main", pose).ok());
  }
  pose.set_bearing_deg(1e9);
  ASSERT_TRUE(client.send_pose("main", pose).ok());
  ASSERT_TRUE(client.get_radar("main", info).ok()) << "its answer is behind those of the poses";
  EXPECT_EQ(info.pose().pose_id(), kPoses - 1u);
  EXPECT_EQ(info.pose().bearing_deg(), (kPoses - 1) % 360);
  ASSERT_EQ(refusals.all.size(), 2u);
  EXPECT_EQ(refusals.all[1].number, number(ErrorNumber::invalid_value));
  ASSERT_EQ(refusals.all[1].fields.size(), 1u);
  EXPECT_EQ(refusals.all[1].fields[0].field, "antenna.bearing_deg");
  client.set_handler(nullptr);
}

TEST(Server, APoseWhereNoFileHasGroundIsTakenWithAWarning) {
  net::ServerOptions options = small_options();
  options.ground_at = [](const PoseSettings& pose, double) {
    return pose.latitude_deg < 60 ? GroundThere{} : GroundThere{0.25, "no file has ground there"};
  };
  const TestServer server(options);
  client::Client client = connect(server);
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::Pose pose;
  pose.set_latitude_deg(61);
  wire::Ack ack;
  ASSERT_TRUE(client.set_pose("main", pose, ack).ok());
  ASSERT_EQ(ack.warnings_size(), 1);
  EXPECT_EQ(ack.warnings(0), "no file has ground there");
  EXPECT_EQ(ack.coverage(), 0.25);
  pose.set_latitude_deg(59);
  ASSERT_TRUE(client.set_pose("main", pose, ack).ok());
  EXPECT_EQ(ack.warnings_size(), 0);
  EXPECT_EQ(ack.coverage(), 1);
}

TEST_F(Served, RefusedSettingsNameEveryFieldAndChangeNothing) {
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_frequency_ghz(std::nan(""));
  settings.set_r_min_m(90000);
  settings.set_power_w(5);
  wire::Ack ack;
  const client::Status status = client.set_settings("main", settings, ack);
  EXPECT_EQ(status.number, number(ErrorNumber::invalid_value));
  EXPECT_GE(status.fields.size(), 2u) << status.sentence();
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().power_w(), 1);
  EXPECT_EQ(info.settings_version(), 1u);

  wire::Pose pose;
  pose.set_height_m(-50);
  EXPECT_EQ(client.set_pose("main", pose, ack).number, number(ErrorNumber::invalid_value))
      << "below the ground";
}

TEST_F(Served, ARadarThatCannotBeRenderedSaysWhyAndRecovers) {
  ASSERT_TRUE(client.claim_control("main").ok());
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  wire::Ack ack;
  wire::Pose pose;
  pose.set_height_m(5);  // the pattern wants an oblique frustum above 10 m
  ASSERT_TRUE(client.set_pose("main", pose, ack).ok());
  client::Status status;
  while (status.ok()) status = client.receive(kLong);
  ASSERT_EQ(status.outcome, Outcome::refused) << status.sentence();
  ASSERT_EQ(status.fields.size(), 1u);
  EXPECT_EQ(status.fields[0].allowed, "sweep, for an antenna so low");
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_NE(info.fault().find("sweep"), std::string::npos);

  pose.set_height_m(500);
  ASSERT_TRUE(client.set_pose("main", pose, ack).ok());
  FrameAssembler frames;
  status = receive_frame(client, frames);
  EXPECT_TRUE(status.ok()) << status.sentence();
}

TEST_F(Served, UnsubscribingEndsTheFrames) {
  EXPECT_EQ(client.unsubscribe("main").number, number(ErrorNumber::not_subscribed));
  ASSERT_TRUE(client.subscribe("main", 100).ok());
  FrameAssembler frames;
  ASSERT_TRUE(receive_frame(client, frames).ok());
  frames.take();
  ASSERT_TRUE(client.unsubscribe("main").ok());
  EXPECT_NE(frames.state(), FrameAssembler::State::receiving)
      << "a begun frame was aborted before the answer";
  EXPECT_EQ(client.receive(client::Timeout(50)).outcome, Outcome::timed_out);
}

TEST_F(Served, ImpossibleRatesAndPlanesAreRefused) {
  for (const double rate_hz : {0.0, -1.0, 1e-300, 1e-6, 1e9, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(client.subscribe("main", rate_hz).number, number(ErrorNumber::invalid_value)) << rate_hz;
  }
}

TEST(Server, TellsItsStatus) {
  const TestServer server;
  client::Client client = connect(server, "pilot");
  ASSERT_TRUE(client.claim_control("nose").ok());
  ASSERT_TRUE(client.subscribe("nose", 50).ok());
  FrameAssembler frames;
  ASSERT_TRUE(receive_frame(client, frames).ok());
  wire::Status status;
  ASSERT_TRUE(client.get_status(status).ok());
  EXPECT_EQ(status.clients(), 1u);
  ASSERT_EQ(status.radars_size(), 2);
  EXPECT_EQ(status.radars(1).controller().rfind("pilot", 0), 0u);
  EXPECT_EQ(status.radars(1).subscribers(), 1u);
  EXPECT_EQ(status.radars(1).rate_hz(), 50);
  EXPECT_EQ(status.radars(0).frames(), 0u) << "nobody watches it, so it is not rendered";
  EXPECT_GT(status.bytes_sent(), 13000u) << "a frame is 20 x 32 x 21 bytes";
}

}  // namespace
}  // namespace obliq::test::server_test
