// What a peer of the WebSocket may send at most, and what it is told beyond.
// obliq replay --serve --http-port: a recording in the browser, with the bytes that were recorded, for
// several at a time.
#include "proto/limits.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/http_peer.h"
#include "tests/integration/record_fixture.h"
#include "tests/integration/web_peer.h"
#include "tests/integration/web_server.h"
#include "tests/support/made_recording.h"

namespace obliq::test::limits_test {
namespace {

using wire::ErrorNumber;
using wire::MessageType;
using Kind = WebPeer::Kind;

constexpr const char* kHello = R"({"request_id": 1, "major": 1, "client_name": "screen"})";

void greet(WebPeer& peer) {
  peer.send(MessageType::hello, kHello);
  EXPECT_NE(peer.await(MessageType::welcome), "");
}

void expect_alive(const WebPattern& pattern) {
  WebPeer peer(pattern.server.web());
  greet(peer);
}

TEST(WebSocketLimits, BeforeHelloAMessageHasAtMost4096Bytes) {
  WebPattern pattern;
  const auto hello = [](std::size_t bytes) {
    const std::string begin = R"({"major": 1, "client_name": ")", end = "\"}";
    return begin + std::string(bytes - begin.size() - end.size(), 'x') + end;
  };
  WebPeer allowed(pattern.server.web());
  allowed.send(MessageType::hello, hello(4096));
  EXPECT_NE(allowed.await(MessageType::welcome), "");
  // One that is just too long, and one that has not even come whole.
  for (const std::size_t bytes : {std::size_t{4097}, std::size_t{300'000}}) {
    WebPeer peer(pattern.server.web());
    peer.send(MessageType::hello, hello(bytes));
    std::string text;
    EXPECT_EQ(peer.error_number(&text), number(ErrorNumber::bad_length)) << text;
    EXPECT_NE(text.find("4096"), std::string::npos) << text;
  }
  expect_alive(pattern);
}

TEST(WebSocketLimits, JsonHasAtMost65536BytesButForALongQuery) {
  WebPattern pattern;
  const std::string most = R"({"radar":")" + std::string(65536 - 12, 'x') + "\"}";
  WebPeer peer(pattern.server.web());
  greet(peer);
  peer.send(MessageType::get_radar, most);
  EXPECT_EQ(peer.error_number(), number(ErrorNumber::unknown_radar));
  for (const auto type : {MessageType::get_radar, MessageType::query_ground}) {
    WebPeer over(pattern.server.web());
    greet(over);
    over.send(type, R"({"request_id":)" + std::string(65536, '1') + "}");
    EXPECT_EQ(over.error_number(), number(ErrorNumber::bad_length));
  }
}

TEST(WebSocketLimits, ALongNameOfAFieldIsToldInFewWords) {
  WebPattern pattern;
  const std::string much(65'000, 'x');
  const std::string digits(65'000, '1');
  for (const std::string& json :
       {"{\"" + much + "\": 1}", R"({"request_id": )" + digits + "}", R"({"request_id": ")" + digits + "\"}",
        R"({"planes": [")" + much + "\"]}", "{'" + much + "': 1}"}) {
    WebPeer peer(pattern.server.web());
    greet(peer);
    peer.send(MessageType::subscribe, json);
    std::string text;
    EXPECT_EQ(peer.error_number(&text), number(ErrorNumber::bad_message)) << json.substr(0, 40);
    EXPECT_EQ(text.find("the JSON of Subscribe: "), 0u) << text;
    EXPECT_LE(text.size(), 200u);
  }
}

using nlohmann::json;

/// The I&Q of the next whole frame.
std::vector<std::complex<float>> iq_of_frame(WebPeer& peer) {
  std::vector<std::complex<float>> iq;
  while (const auto message = peer.read()) {
    wire::MessageView view;
    const wire::Bytes binary = as_protobuf(*message);
    EXPECT_EQ(wire::decode_message(binary, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
    if (view.header.type == MessageType::frame_begin) iq.assign(kMadeAzimuths * kMadeRanges, {});
    if (view.header.type == MessageType::frame_end && !iq.empty()) return iq;
    wire::WedgeBlock block;
    if (view.header.type != MessageType::wedge_block || !wire::parse_descriptor(view.descriptor, block))
      continue;
    if (block.plane() != wire::IQ || iq.empty()) continue;
    EXPECT_EQ(view.plane.size(), block.n_azimuth() * block.n_range() * sizeof iq[0]);
    std::memcpy(iq.data() + block.first_azimuth() * kMadeRanges, view.plane.data(), view.plane.size());
  }
  return {};
}

TEST_F(RecordTest, WebSocketReplayShowsTheRecordedBytesToSeveral) {
  folder.write("main.obliq", made_recording().bytes);
  const auto expected = frames_of(file);
  ASSERT_FALSE(expected.empty());
  const Running replay({"replay", file, "--serve", "--port", "0", "--http-port", "0", "--loop"},
                       folder / "replay.log");
  const std::string url = replay.await("in a browser: ");
  ASSERT_EQ(url.rfind("http://127.0.0.1:", 0), 0u) << replay.log();
  const auto at = *client::parse_endpoint(url.substr(7, url.find('/', 7) - 7));
  EXPECT_EQ(http_get(at.port, "/").body,
            text_of(std::filesystem::path(OBLIQ_SOURCE_DIR "/server/http/page/index.html")));
  EXPECT_EQ(http_get(at.port, "/readyz").status, 200);
  EXPECT_EQ(http_get(at.port, "/parameters.json").status, 200);
  EXPECT_EQ(WebPeer(at, {.origin = "http://evil.example"}).status(), 403);
  WebPeer rude(at);
  rude.send(MessageType::hello, R"({"client_name": ")" + std::string(300'000, 'x') + "\"}");
  EXPECT_EQ(rude.error_number(), static_cast<std::uint32_t>(wire::ErrorNumber::bad_length));
  WebPeer student(at), instructor(at);
  for (WebPeer* peer : {&student, &instructor}) {
    peer->send(MessageType::hello, R"({"major": 1})");
    EXPECT_EQ(json::parse(peer->await(MessageType::welcome)).at("server_name"), "obliq replay");
    peer->send(MessageType::subscribe,
               R"({"request_id": 1, "radar": "main", "rate_hz": 100, "planes": ["IQ"]})");
  }
  for (WebPeer* peer : {&student, &instructor, &student}) {
    const auto iq = iq_of_frame(*peer);
    EXPECT_TRUE(std::ranges::any_of(expected, [&](const auto& one) { return one.second.iq == iq; }));
  }
  student.send(MessageType::claim_control, R"({"request_id": 2, "radar": "main"})");
  EXPECT_EQ(student.error_number(), static_cast<std::uint32_t>(wire::ErrorNumber::replay_only));
}

}  // namespace
}  // namespace obliq::test::limits_test
