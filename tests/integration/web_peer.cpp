#include "tests/integration/web_peer.h"

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

#include "tests/integration/clients.h"
#include "tests/integration/session/session_record.h"

namespace obliq::test {
namespace {

// RFC 6455 section 1.3 has this key and what it must be answered.
constexpr const char* kKey = "dGhlIHNhbXBsZSBub25jZQ==";
constexpr const char* kAccept = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";

constexpr std::array kMask{std::byte{0x37}, std::byte{0xfa}, std::byte{0x21}, std::byte{0x3d}};

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace

wire::Bytes web_message(wire::MessageType type, std::string_view json) {
  wire::MessageHeader header{.type = type, .flags = 1};
  header.descriptor_length = header.payload_length = static_cast<std::uint32_t>(json.size());
  wire::Bytes bytes(wire::kHeaderBytes);
  wire::encode_header(header, std::span(bytes).first<wire::kHeaderBytes>());
  const auto text = bytes_of(json);
  bytes.insert(bytes.end(), text.begin(), text.end());
  return bytes;
}

std::string json_of(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string text;
  EXPECT_TRUE(google::protobuf::util::MessageToJsonString(message, &text, options).ok());
  return text;
}

wire::Bytes as_protobuf(const wire::Bytes& message) {
  wire::MessageHeader header;
  const std::span all(message);
  EXPECT_EQ(wire::decode_header(all.first<wire::kHeaderBytes>(), 1 << 24, header), wire::HeaderStatus::ok);
  EXPECT_EQ(header.flags, 1);
  EXPECT_EQ(header.crc, 0u);
  EXPECT_EQ(message.size(), wire::kHeaderBytes + header.payload_length);
  const auto json = all.subspan(wire::kHeaderBytes, header.descriptor_length);
  const auto descriptor = empty_message(header.type);
  const auto status = google::protobuf::util::JsonStringToMessage(
      {reinterpret_cast<const char*>(json.data()), json.size()}, descriptor.get(), {});
  EXPECT_TRUE(status.ok()) << status.ToString();
  return wire::encode_message(header.type, {header.stream_id, header.sequence, header.utc_ns}, *descriptor,
                              all.subspan(wire::kHeaderBytes + header.descriptor_length));
}

WebPeer::WebPeer(const client::Endpoint& server, const WebRequest& request) {
  EXPECT_TRUE(is_ok(client::Socket::connect(server, kLong, socket_)));
  if (!request.ca_file.empty()) {
    EXPECT_TRUE(is_ok(socket_.start_tls(server.host, {true, request.ca_file}, kLong)));
  }
  std::string text = "GET " + request.path +
                     " HTTP/1.1\r\nHost: " + (request.host.empty() ? server.text() : request.host) +
                     "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: " +
                     kKey + "\r\n";
  if (!request.protocol.empty()) text += "Sec-WebSocket-Protocol: " + request.protocol + "\r\n";
  if (!request.origin.empty()) text += "Origin: " + request.origin + "\r\n";
  send_raw(bytes_of(text + "\r\n"));
  char one = 0;
  while (!answer_.ends_with("\r\n\r\n") && receive(std::as_writable_bytes(std::span(&one, 1))))
    answer_ += one;
  if (answer_.size() > 12) status_ = std::stoi(answer_.substr(9));
  if (status_ == 101) {
    EXPECT_NE(answer_.find(std::string("Sec-WebSocket-Accept: ") + kAccept + "\r\n"), std::string::npos)
        << answer_;
    EXPECT_NE(answer_.find("Sec-WebSocket-Protocol: obliq.v1.json\r\n"), std::string::npos) << answer_;
  } else if (status_ != 0) {
    const std::string name = "Content-Length: ";
    std::string body(std::stoul("0" + answer_.substr(answer_.find(name) + name.size())), '\0');
    if (receive(std::as_writable_bytes(std::span(body)))) answer_ += body;
  }
}

bool WebPeer::receive(std::span<std::byte> bytes) { return socket_.receive(bytes, kLong).ok(); }

// The server may have closed already; what it said counts.
void WebPeer::send_raw(std::span<const std::byte> bytes) { (void)socket_.send(bytes, kLong).ok(); }

void WebPeer::send(const Frame& frame) {
  wire::Bytes raw{static_cast<std::byte>(static_cast<unsigned>(frame.kind) | (frame.last ? 0x80u : 0u))};
  const std::size_t n = frame.bytes.size();
  const unsigned mask = frame.masked ? 0x80u : 0u;
  const int length_bytes = n < 126 ? 0 : n < 65536 ? 2 : 8;
  raw.push_back(static_cast<std::byte>(mask | (length_bytes == 0 ? n : length_bytes == 2 ? 126u : 127u)));
  for (int i = length_bytes - 1; i >= 0; --i) raw.push_back(static_cast<std::byte>(n >> (8 * i) & 0xff));
  if (frame.masked) raw.insert(raw.end(), kMask.begin(), kMask.end());
  for (std::size_t i = 0; i < n; ++i)
    raw.push_back(frame.masked ? frame.bytes[i] ^ kMask[i % kMask.size()] : frame.bytes[i]);
  send_raw(raw);
}

std::optional<WebPeer::Frame> WebPeer::read_frame() {
  std::array<std::byte, 2> head;
  if (!receive(head)) return std::nullopt;
  Frame frame{
      static_cast<Kind>(std::to_integer<unsigned>(head[0]) & 15u), {}, (head[0] >> 7) == std::byte{1}, false};
  EXPECT_EQ(std::to_integer<unsigned>(head[0]) & 0x70u, 0u) << "no extension is agreed on";
  EXPECT_EQ(std::to_integer<unsigned>(head[1]) & 0x80u, 0u) << "a server masks nothing";
  std::uint64_t n = std::to_integer<std::uint64_t>(head[1]);
  if (n >= 126) {
    wire::Bytes length(n == 126 ? 2 : 8);
    if (!receive(length)) return std::nullopt;
    n = 0;
    for (const std::byte b : length) n = n << 8 | std::to_integer<std::uint64_t>(b);
  }
  frame.bytes.resize(n);
  if (!receive(frame.bytes)) return std::nullopt;
  return frame;
}

void WebPeer::send(wire::MessageType type, std::string_view json) {
  send({Kind::binary, web_message(type, json)});
}

std::optional<wire::Bytes> WebPeer::read() {
  while (auto frame = read_frame()) {
    if (frame->kind == Kind::close) break;
    if (frame->kind == Kind::ping || frame->kind == Kind::pong) continue;
    EXPECT_EQ(frame->kind, Kind::binary);
    EXPECT_TRUE(frame->last);
    return std::move(frame->bytes);
  }
  return std::nullopt;
}

std::string WebPeer::await(wire::MessageType type) {
  while (const auto message = read()) {
    wire::MessageHeader header;
    const std::span all(*message);
    EXPECT_EQ(wire::decode_header(all.first<wire::kHeaderBytes>(), 1 << 24, header), wire::HeaderStatus::ok);
    const auto json = all.subspan(wire::kHeaderBytes, header.descriptor_length);
    if (header.type == type) return {reinterpret_cast<const char*>(json.data()), json.size()};
  }
  return "";
}

std::uint32_t WebPeer::error_number(std::string* text) {
  const std::string json = await(wire::MessageType::error);
  if (json.empty()) return 0;
  const auto error = nlohmann::json::parse(json);
  if (text != nullptr) *text = error.value("text", "");
  return error.value("number", 0u);
}

}  // namespace obliq::test
