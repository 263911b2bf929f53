// What a peer of the WebSocket may send at most, and what it is told beyond.
#include <gtest/gtest.h>

#include "proto/limits.h"
#include "tests/integration/web_server.h"

namespace obliq::test {
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

TEST(WebSocketLimits, AMessageThatOnlyAsProtobufIsTooLongIsRefusedAndTheServerLives) {
  WebPattern pattern;
  WebPeer peer(pattern.server.web());
  greet(peer);
  std::string ones = "[1";  // two bytes each, as protobuf eight
  for (std::uint32_t i = 1; i < wire::kMaxQueryPoints; ++i) ones += ",1";
  ones += "]";
  peer.send(MessageType::query_ground, R"({"latitude_deg":)" + ones + R"(,"longitude_deg":)" + ones +
                                           R"(,"bearing_deg":)" + ones + R"(,"range_m":)" + ones + "}");
  std::string text;
  EXPECT_EQ(peer.error_number(&text), number(ErrorNumber::bad_length)) << text;
  EXPECT_NE(text.find("allowed: at most 262144"), std::string::npos) << text;
  EXPECT_FALSE(peer.read()) << "and then the end";
  expect_alive(pattern);
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

// RFC 6455 section 5.2: "the most significant bit MUST be 0".
TEST(WebSocketLimits, ALengthWithItsHighestBitSetIsClosedWith1002) {
  WebPattern pattern;
  for (const unsigned rest : {0x00u, 0xffu}) {
    wire::Bytes frame(14, static_cast<std::byte>(rest));
    frame[0] = std::byte{0x82};
    frame[1] = std::byte{0xff};
    frame[2] = static_cast<std::byte>(0x80u | rest);
    WebPeer peer(pattern.server.web());
    greet(peer);
    peer.send_raw(std::span(frame).first(5));
    peer.send_raw(std::span(frame).subspan(5));
    const auto answer = peer.read_frame();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->kind, Kind::close);
    EXPECT_EQ(answer->bytes, (wire::Bytes{std::byte{1002 >> 8}, std::byte{1002 & 0xff}}));
  }
}

// RFC 6455 section 4.1: a base64-encoded value that, when decoded, is 16 bytes in length.
TEST(WebSocketLimits, AKeyThatIsNot16BytesOfBase64Is400) {
  const WebPattern pattern;
  for (const char* key :
       {"short", "dGhlIHNhbXBsZSBub25jZQ", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25jZSE=",
        "dGhlIHNhbXBsZSBub2 jZQ==", "dGhlIHNhbXBsZSBub25jZSBhbmQgbW9yZQ=="}) {
    const WebPeer peer(pattern.server.web(), {.key = key});
    EXPECT_EQ(peer.status(), 400) << key;
    EXPECT_NE(peer.answer().find("Sec-WebSocket-Key"), std::string::npos) << peer.answer();
  }
  const WebPeer twice(pattern.server.web(), {.more = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"});
  EXPECT_EQ(twice.status(), 400);
}

TEST(WebSocketLimits, TwoOriginsAndTwoHostsAre400) {
  const WebPattern pattern;
  const std::string own = "http://" + pattern.server.web().text();
  EXPECT_EQ(WebPeer(pattern.server.web(), {.origin = own}).status(), 101);
  EXPECT_EQ(
      WebPeer(pattern.server.web(), {.origin = own, .more = "Origin: http://evil.example\r\n"}).status(),
      400);
  EXPECT_EQ(WebPeer(pattern.server.web(), {.more = "Host: evil.example\r\n"}).status(), 400);
}

}  // namespace
}  // namespace obliq::test
