// The WebSocket's door: who is let in, what is refused and in which words, and that nobody else notices.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/obliq.pb.h"
#include "server/security/security.h"
#include "tests/integration/daemon.h"
#include "tests/integration/test_certificate.h"
#include "tests/integration/web_server.h"

namespace obliq::test::door_test {
namespace {

using nlohmann::json;
using wire::ErrorNumber;
using wire::MessageType;
using Frame = WebPeer::Frame;
using Kind = WebPeer::Kind;
using Pattern = WebPattern;

constexpr const char* kHello = R"({"request_id": 1, "major": 1, "client_name": "screen"})";
constexpr const char* kWatch = R"({"request_id": 2, "radar": "main", "rate_hz": 50})";

client::Client tcp_client(const client::Endpoint& server) {
  client::Client made;
  EXPECT_TRUE(is_ok(made.connect(server)));
  return made;
}

wire::Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

/// Of radar "main", watched over the WebSocket, until the frame is whole; the values of its plane POWER.
std::vector<double> powers_of_frame(WebPeer& peer) {
  std::vector<double> powers(20 * 32);
  std::size_t values = 0;
  while (values < powers.size()) {
    const auto message = peer.read();
    if (!message) break;
    wire::MessageView view;
    const wire::Bytes binary = as_protobuf(*message);
    EXPECT_EQ(wire::decode_message(binary, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
    wire::WedgeBlock block;
    if (view.header.type != MessageType::wedge_block || !wire::parse_descriptor(view.descriptor, block))
      continue;
    if (block.plane() != wire::POWER) continue;
    const std::size_t n = block.n_azimuth() * block.n_range();
    EXPECT_EQ(view.plane.size(), n * sizeof(double));
    std::memcpy(powers.data() + std::size_t{block.first_azimuth()} * 32, view.plane.data(),
                n * sizeof(double));
    values += n;
  }
  return powers;
}

void expect_pattern_powers(const std::vector<double>& powers) {
  const RadarConfig radar = small_radar("main");
  for (int a = 0; a < 20; ++a)
    for (int r = 0; r < 32; ++r)
      ASSERT_EQ(powers[static_cast<std::size_t>(a * 32 + r)], pattern_power(radar.settings, radar.pose, a, r))
          << a << ", " << r;
}

TEST(WebSocketDoor, TheBytesInTheGuideForUnrealSubscribe) {
  Pattern pattern;
  WebPeer peer(pattern.server.web());
  peer.send(MessageType::hello, kHello);
  peer.send({Kind::binary, bytes_of_block(OBLIQ_SOURCE_DIR "/client/guide/unreal.md", "subscribe")});
  EXPECT_EQ(json::parse(peer.await(MessageType::ack)).at("request_id"), "1");
}

TEST(WebSocketDoor, ThroughTlsAndWithATokenItIsTheSame) {
  const TestFolder folder;
  const TestCertificate own = make_certificate(folder.path(), "own");
  const std::string tokens = folder.write("tokens", "viewer viewer-token-0123456789\n");
  std::filesystem::permissions(tokens, std::filesystem::perms::owner_read);
  net::ServerOptions options = patient_options();
  options.security =
      std::make_shared<security::Security>(security::SecurityFiles{tokens, own.certificate, own.key});
  Pattern pattern(options);
  WebPeer peer(pattern.server.web(),
               {.origin = "https://" + pattern.server.web().text(), .ca_file = own.certificate});
  ASSERT_EQ(peer.status(), 101) << peer.answer();
  peer.send(MessageType::hello, R"({"major": 1, "token": "viewer-token-0123456789"})");
  EXPECT_EQ(json::parse(peer.await(MessageType::welcome)).at("role"), "viewer");
  peer.send(MessageType::subscribe, kWatch);
  for (int i = 0; i < 3; ++i) expect_pattern_powers(powers_of_frame(peer));
  WebPeer stranger(pattern.server.web(), {.ca_file = own.certificate});
  stranger.send(MessageType::hello, R"({"major": 1, "token": "another-token-0123456789"})");
  EXPECT_EQ(stranger.error_number(), number(ErrorNumber::token_refused));
  WebPeer plain(pattern.server.web());
  EXPECT_EQ(plain.status(), 400);
  EXPECT_NE(plain.answer().find("HTTPS only"), std::string::npos) << plain.answer();
}

TEST(WebSocketDoor, OtherHostsOriginsAndSubprotocolsAreRefused) {
  Pattern pattern;
  const client::Endpoint web = pattern.server.web();
  EXPECT_EQ(WebPeer(web, {.host = "evil.example"}).status(), 403);
  EXPECT_EQ(WebPeer(web, {.origin = "http://evil.example"}).status(), 403);
  EXPECT_EQ(WebPeer(web, {.origin = "null"}).status(), 403);
  EXPECT_EQ(WebPeer(web, {.host = "evil.example", .origin = "http://evil.example"}).status(), 403);
  EXPECT_EQ(WebPeer(web, {.origin = "http://" + web.text()}).status(), 101);
  for (const char* protocol : {"", "chat", "obliq.v2.json", "obliq.v1.json.x"}) {
    const WebPeer peer(web, {.protocol = protocol});
    EXPECT_EQ(peer.status(), 400) << protocol;
    EXPECT_NE(peer.answer().find("allowed: obliq.v1.json"), std::string::npos) << peer.answer();
  }
  EXPECT_EQ(WebPeer(web, {.protocol = "chat, obliq.v1.json"}).status(), 101);
  EXPECT_EQ(WebPeer(web, {.path = "/stream?x=1"}).status(), 101);
  EXPECT_EQ(WebPeer(web, {.path = "/streams"}).status(), 404);
}

/// What a client sends after Welcome, and the Error that it gets.
struct Wrong {
  const char* name;
  Frame frame;
  ErrorNumber number;
  const char* text;
};

TEST(WebSocketDoor, WhatIsNoMessageIsRefusedInWords) {
  Pattern pattern;
  client::Client other = tcp_client(pattern.server.tcp());
  client::FrameAssembler frames;
  ASSERT_TRUE(other.subscribe("main", 50).ok());
  const auto changed = [](std::size_t at, unsigned value) {
    wire::Bytes bytes = web_message(MessageType::get_status, "{}");
    bytes[at] = static_cast<std::byte>(value);
    return bytes;
  };
  const auto binary = [](wire::Bytes bytes) { return Frame{Kind::binary, std::move(bytes)}; };
  const auto posed = [&](const std::string& text) {
    return binary(web_message(MessageType::set_pose, text));
  };
  const Wrong all[] = {
      {"text", {Kind::text, bytes_of("{\"major\": 1}")}, ErrorNumber::bad_length, "a text message"},
      {"2 MB", binary(wire::Bytes(2 << 20)), ErrorNumber::bad_length, "allowed: 1048576 behind"},
      {"nothing", binary({}), ErrorNumber::bad_length, "a message of 0 bytes"},
      {"half a header", binary(wire::Bytes(24, std::byte{'O'})), ErrorNumber::bad_length,
       "a message of 24 bytes"},
      {"less than announced", binary(changed(12, 99)), ErrorNumber::bad_length, "its header announces"},
      {"descriptor beyond the payload", binary(changed(16, 99)), ErrorNumber::bad_length, "protobuf 99"},
      {"another magic", binary(changed(0, 'X')), ErrorNumber::bad_magic, "OBLQ"},
      {"another version", binary(changed(4, 2)), ErrorNumber::version_mismatch, "found 2."},
      {"protobuf", binary(changed(8, 0)), ErrorNumber::bad_message, "bit 0 set"},
      {"no JSON", posed("{"), ErrorNumber::bad_message, "the JSON of SetPose: "},
      {"a list", posed("[]"), ErrorNumber::bad_message, "the JSON of SetPose: "},
      {"an unknown field", posed(R"({"pose":{"bering_deg":1}})"), ErrorNumber::bad_message, "bering_deg"},
      {"a text for a number", posed(R"({"pose":{"bearing_deg":"north"}})"), ErrorNumber::bad_message,
       "bearing_deg"},
      {"an unknown enum", posed(R"({"pose":{"height_reference":"MOON"}})"), ErrorNumber::bad_message, "MOON"},
      {"too large a number", posed(R"({"pose":{"bearing_deg":1e400}})"), ErrorNumber::bad_message, "double"},
      {"deep", posed(R"({"pose":[[[[)"), ErrorNumber::bad_message, "pose: found a list; allowed: an object"},
  };
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.name);
    WebPeer peer(pattern.server.web());
    peer.send(MessageType::hello, kHello);
    EXPECT_NE(peer.await(MessageType::welcome), "");
    peer.send(wrong.frame);
    std::string text;
    EXPECT_EQ(peer.error_number(&text), number(wrong.number)) << text;
    EXPECT_NE(text.find(wrong.text), std::string::npos) << text;
    EXPECT_FALSE(peer.read()) << "and then the end";
  }
  ASSERT_TRUE(receive_frame(other, frames).ok());
  expect_pattern(frames.take());
}

TEST(WebSocketDoor, AValueThatIsRefusedIsAnsweredAndTheConnectionGoesOn) {
  Pattern pattern;
  WebPeer peer(pattern.server.web());
  peer.send(MessageType::hello, kHello);
  peer.send(MessageType::claim_control, R"({"request_id": 7, "radar": "main"})");
  EXPECT_EQ(json::parse(peer.await(MessageType::ack)).at("request_id"), "7");
  peer.send(MessageType::set_pose,
            R"({"request_id": "8", "radar": "main", "pose": {"latitude_deg": 95, "bearing_deg": "NaN"}})");
  const json error = json::parse(peer.await(MessageType::error));
  EXPECT_EQ(error.at("request_id"), "8");
  EXPECT_EQ(error.at("number"), 100);
  EXPECT_EQ(error.at("fields").size(), 2u);
  EXPECT_EQ(error.at("fields").at(0).at("field"), "antenna.latitude_deg");
  // 0 is a value, not an absent field.
  peer.send(MessageType::set_pose, R"({"request_id": 9, "radar": "main", "pose": {"bearing_deg": 0}})");
  EXPECT_NE(peer.await(MessageType::ack), "");
  peer.send(MessageType::get_radar, R"({"request_id": 10, "radar": "main"})");
  const json info = json::parse(peer.await(MessageType::radar_info));
  EXPECT_EQ(info.at("pose").at("bearing_deg"), 0) << info;
}

TEST(WebSocketDoor, AMessageMayComeInPiecesWithPingsBetweenThem) {
  Pattern pattern;
  WebPeer peer(pattern.server.web());
  const wire::Bytes hello = web_message(MessageType::hello, kHello);
  for (std::size_t i = 0; i < hello.size(); ++i) {
    peer.send({i == 0 ? Kind::binary : Kind::continuation, {hello[i]}, i + 1 == hello.size()});
    if (i == 50) peer.send({Kind::ping, bytes_of("are you there")});
  }
  const auto pong = peer.read_frame();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->kind, Kind::pong);
  EXPECT_EQ(pong->bytes, bytes_of("are you there"));
  EXPECT_NE(peer.await(MessageType::welcome), "");
}

TEST(WebSocketDoor, WhoClosesGivesUpControl) {
  Pattern pattern;
  {
    WebPeer peer(pattern.server.web());
    peer.send(MessageType::hello, kHello);
    peer.send(MessageType::claim_control, R"({"request_id": 2, "radar": "main"})");
    EXPECT_NE(peer.await(MessageType::ack), "");
    peer.send({Kind::close, {std::byte{3}, std::byte{232}}});  // 1000
    const auto answer = peer.read_frame();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->kind, Kind::close);
    EXPECT_FALSE(peer.read_frame());
  }
  WebPeer next(pattern.server.web());
  next.send(MessageType::hello, kHello);
  EXPECT_NE(next.await(MessageType::welcome), "");
  next.send(MessageType::claim_control, R"({"request_id": 2, "radar": "main"})");
  EXPECT_EQ(json::parse(next.await(MessageType::ack)).at("request_id"), "2");
}

TEST(WebSocketDoor, AScreenThatDoesNotReadIsDroppedLikeAnyClient) {
  net::ServerOptions options = patient_options();
  options.stall_timeout_s = 0.5;
  Pattern pattern(options);
  WebPeer stalled(pattern.server.web());
  stalled.send(MessageType::hello, kHello);
  stalled.send(MessageType::render_once, json_of(large_once_request()));
  client::Client watching = tcp_client(pattern.server.tcp());
  while (status_of(watching).clients() > 1) {
  }
}

TEST(WebSocketDoor, WhileTheDaemonLoadsItIsRefusedWithTheStage) {
  const TestFolder folder;
  const std::string scene =
      folder.write("scene.toml", text_of(SmallScene{.terrain = "synthetic = \"hills\"\n"}));
  const Daemon daemon({"--config", scene, "--set", "terrain.cell_m=2.5"}, folder.path(), "loading terrain");
  const std::string log = daemon.log();
  const std::size_t at = log.find("HTTP on ") + 8;
  const WebPeer peer(*client::parse_endpoint(log.substr(at, log.find(": ", at) - at)));
  EXPECT_EQ(peer.status(), 503);
  EXPECT_NE(peer.answer().find("loading: "), std::string::npos) << peer.answer();
}

}  // namespace
}  // namespace obliq::test::door_test
