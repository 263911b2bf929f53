#pragma once
// Clients of a few lines that read and drop, so that a benchmark measures the server: over TCP, and over a
// WebSocket.
#include <cstddef>
#include <vector>

#include "client/socket.h"
#include "proto/message_codec.h"

namespace google::protobuf {
class Message;
}

namespace obliq::bench {

/// Ends the program when the connection fails.
class Reader {
 public:
  explicit Reader(const client::Endpoint& server);
  virtual ~Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  virtual void send(wire::MessageType type, const google::protobuf::Message& message) = 0;
  /// The next message's header.
  virtual wire::MessageHeader read() = 0;
  /// Of radar "main".
  void watch(double rate_hz, bool lossless);

 protected:
  wire::MessageHeader decoded(std::span<const std::byte> bytes) const;
  void receive(std::size_t bytes);

  client::Socket socket_;
  std::vector<std::byte> buffer_;
};

class TcpReader : public Reader {
 public:
  explicit TcpReader(const client::Endpoint& server);
  void send(wire::MessageType type, const google::protobuf::Message& message) override;
  wire::MessageHeader read() override;
};

/// RFC 6455 as far as it is needed.
class WebReader : public Reader {
 public:
  explicit WebReader(const client::Endpoint& server);
  void send(wire::MessageType type, const google::protobuf::Message& message) override;
  wire::MessageHeader read() override;
};

}  // namespace obliq::bench
