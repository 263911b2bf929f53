#pragma once
// Messages over a socket: framing, limits, CRC. Does not interpret them.
#include <array>
#include <cstddef>
#include <span>

#include "client/socket.h"
#include "proto/message_codec.h"

namespace obliq::client {

/// A received message. The spans point into it.
struct Message {
  wire::MessageHeader header;
  std::array<std::byte, wire::kMaxHeaderBytes> head{};  ///< of which header.header_length are the header
  wire::Bytes payload;

  std::span<const std::byte> descriptor() const { return std::span(payload).first(header.descriptor_length); }
  /// The header as it came, with what a later version may have put at its end.
  std::span<const std::byte> header_bytes() const { return std::span(head).first(header.header_length); }
  /// The whole message as it came.
  wire::Bytes bytes() const;
  std::span<const std::byte> plane() const { return std::span(payload).subspan(header.descriptor_length); }
};

/// One thread at a time.
class Connection {
 public:
  static Status open(const Endpoint& endpoint, const TlsOptions& tls, Timeout timeout, Connection& out);

  Status send(wire::MessageType type, const google::protobuf::MessageLite& message);

  /// The next message, whatever its type. timed_out leaves the connection usable: it means that no message
  /// has begun to arrive. After any other failure the connection is closed.
  Status receive(Message& message, Timeout timeout);

  bool is_open() const { return socket_.is_open(); }
  void close() { socket_.close(); }

 private:
  Status receive_begun(Message& message);
  Status foreign(std::span<const std::byte> magic);
  Status explain_tls_failure(Status failure, Timeout timeout);

  Socket socket_;
  std::uint64_t sequence_ = 0;
};

}  // namespace obliq::client
