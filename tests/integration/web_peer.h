#pragma once
// A WebSocket client of a few lines (RFC 6455), apart from any library, so that a test can also send what no
// library would.
#include <optional>
#include <string>
#include <string_view>

#include "client/socket.h"
#include "proto/message_codec.h"
#include "tests/support/page_block.h"

namespace google::protobuf {
class Message;
}

namespace obliq::test {

struct WebRequest {
  std::string path = "/stream";
  std::string host{};  ///< empty: where it connects
  std::string protocol = "obliq.v1.json";
  std::string origin{};   ///< empty: none, as of a program that is no browser
  std::string ca_file{};  ///< empty: without TLS
};

class WebPeer {
 public:
  explicit WebPeer(const client::Endpoint& server, const WebRequest& request = {});

  /// Of the answer to the opening handshake; 101: it is a WebSocket. 0: closed without an answer.
  int status() const { return status_; }
  const std::string& answer() const { return answer_; }  ///< header and, where it is refused, the body

  enum class Kind : unsigned { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };
  struct Frame {
    Kind kind{};
    wire::Bytes bytes{};
    bool last = true;
    bool masked = true;
  };
  void send(const Frame& frame);
  void send_raw(std::span<const std::byte> bytes);
  /// The next frame; nothing when the server has closed.
  std::optional<Frame> read_frame();

  /// A message of the stream, in one frame.
  void send(wire::MessageType type, std::string_view json);
  /// The next message; pings and pongs are skipped. Nothing after a close frame or the end.
  std::optional<wire::Bytes> read();
  /// Reads until a message of that type; its JSON. Empty when it does not come.
  std::string await(wire::MessageType type);
  /// Of the Error that comes before the end, skipping other messages; 0: none came.
  std::uint32_t error_number(std::string* text = nullptr);

 private:
  bool receive(std::span<std::byte> bytes);

  client::Socket socket_;
  int status_ = 0;
  std::string answer_;
};

/// Header (flag 1, no CRC) and JSON.
wire::Bytes web_message(wire::MessageType type, std::string_view json);
/// A message with JSON as the stream has it, by protobuf's own reader of JSON.
wire::Bytes as_protobuf(const wire::Bytes& message);
/// By protobuf's own writer.
std::string json_of(const google::protobuf::Message& message);

}  // namespace obliq::test
