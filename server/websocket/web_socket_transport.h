#pragma once
#include <memory>
#include <string>
#include <utility>  // Boost 1.74 uses std::exchange without including it

#include "server/net/socket_transport.h"

namespace boost::asio {
class io_context;
}

namespace obliq::websocket {

/// A WebSocket (RFC 6455) on a connection that HTTP has handed over, for a session like all others: the
/// session reads and writes messages of the stream, the peer has one message with a JSON descriptor in each
/// binary message (json_message.h). Text messages, messages that are too long and JSON that is not that of
/// its message are refused, after which nothing is read but the end.
class WebSocketTransport final : public net::Transport {
 public:
  /// `header`: of the request, as text; `unread`: what has come behind it.
  WebSocketTransport(boost::asio::io_context& io, std::unique_ptr<net::SocketTransport> socket,
                     std::string header, std::string unread);
  ~WebSocketTransport() override;

  std::string host() const override;
  std::string address() const override;
  /// The opening handshake.
  void start(Started done) override;
  bool is_ready() const override;
  std::string description() const override;
  void expect(const wire::MessageLimits& limits) override;
  /// The first byte of a message as soon as any of it has come, so that the session's time limit begins; the
  /// others when it is whole and has been translated.
  void read(std::span<std::byte> bytes, bool some, Done done) override;
  Fault fault() const override;
  bool takes_json() const override { return true; }
  void write(const stream::Block& message, Done done) override;
  /// Our part of the closing handshake; a read sees the peer's.
  void finish(Done done) override;
  void close() override;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace obliq::websocket
