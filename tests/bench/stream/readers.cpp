#include "tests/bench/stream/readers.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "proto/json_text.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::bench {
namespace {

constexpr client::Timeout kLong{60000};

void check(const client::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "a reader's connection failed: %s\n", status.sentence().c_str());
  std::exit(1);
}

wire::Hello hello() {
  wire::Hello message;
  message.set_major(wire::kMajorVersion);
  return message;
}

}  // namespace

Reader::Reader(const client::Endpoint& server) : buffer_(std::size_t{2} << 20) {
  check(client::Socket::connect(server, kLong, socket_));
}

void Reader::watch(double rate_hz, bool lossless) {
  wire::Subscribe request;
  request.set_request_id(2);
  request.set_radar("main");
  request.set_rate_hz(rate_hz);
  request.set_lossless(lossless);
  request.add_planes(wire::VIDEO);
  send(wire::MessageType::subscribe, request);
}

wire::MessageHeader Reader::decoded(std::span<const std::byte> bytes) const {
  wire::MessageHeader header;
  const auto status = wire::decode_header(bytes.first<wire::kHeaderBytes>(), wire::kMaxPayloadBytes, header);
  if (status != wire::HeaderStatus::ok) {
    std::fprintf(stderr, "a reader got what is no message\n");
    std::exit(1);
  }
  return header;
}

void Reader::receive(std::size_t bytes) { check(socket_.receive(std::span(buffer_).first(bytes), kLong)); }

TcpReader::TcpReader(const client::Endpoint& server) : Reader(server) {
  send(wire::MessageType::hello, hello());
}

void TcpReader::send(wire::MessageType type, const google::protobuf::Message& message) {
  check(socket_.send(wire::encode_message(type, {}, message), kLong));
}

wire::MessageHeader TcpReader::read() {
  receive(wire::kHeaderBytes);
  const wire::MessageHeader header = decoded(buffer_);
  receive(header.payload_length);
  return header;
}

WebReader::WebReader(const client::Endpoint& server) : Reader(server) {
  const std::string request =
      "GET /stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
      "Sec-WebSocket-Protocol: obliq.v1.json\r\n\r\n";
  check(socket_.send(std::as_bytes(std::span(request)), kLong));
  std::string answer;
  for (char one = 0; !answer.ends_with("\r\n\r\n"); answer += one)
    check(socket_.receive(std::as_writable_bytes(std::span(&one, 1)), kLong));
  send(wire::MessageType::hello, hello());
}

void WebReader::send(wire::MessageType type, const google::protobuf::Message& message) {
  const std::string message_as_json = wire::json_head(type, {}, message, 0);
  // Masked with 0. The length has as few bytes as it needs (RFC 6455 section 5.2).
  const std::size_t n = message_as_json.size();
  std::string frame = "\x82";
  if (n < 126) {
    frame += static_cast<char>(0x80 | n);
  } else {
    frame += {'\xfe', static_cast<char>(n >> 8), static_cast<char>(n & 0xff)};
  }
  frame.append(4, '\0');
  frame += message_as_json;
  check(socket_.send(std::as_bytes(std::span(frame)), kLong));
}

wire::MessageHeader WebReader::read() {
  receive(2);
  std::size_t n = std::to_integer<std::size_t>(buffer_[1]);
  if (n >= 126) {
    const std::size_t digits = n == 126 ? 2 : 8;
    receive(digits);
    n = 0;
    for (std::size_t i = 0; i < digits; ++i) n = n << 8 | std::to_integer<std::size_t>(buffer_[i]);
  }
  receive(n);
  return decoded(buffer_);
}

}  // namespace obliq::bench
