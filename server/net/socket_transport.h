#pragma once
#include <memory>

#include "server/net/transport.h"

namespace boost::asio {
class io_context;
namespace ssl {
class context;
}
}  // namespace boost::asio

namespace obliq::net {

/// The bytes of a socket, through TLS where the server has it.
class SocketTransport final : public Transport {
 public:
  /// Takes the connected socket. tls null: plain.
  SocketTransport(boost::asio::io_context& io, int socket_fd, bool is_ipv6,
                  std::shared_ptr<boost::asio::ssl::context> tls);
  ~SocketTransport() override;

  std::string host() const override;
  std::string address() const override;
  void start(Started done) override;
  bool is_ready() const override;
  /// Of a session that runs its TLS version and cipher; "plain" without TLS.
  std::string description() const override;
  void read(std::span<std::byte> bytes, bool some, Done done) override;
  void write(const stream::Block& message, Done done) override;
  void write(std::span<const std::byte> bytes, Done done);
  void finish(Done done) override;
  void close() override;

  using Counted = std::function<void(Transfer, std::size_t)>;
  /// Fills a part of the buffer; tells how many bytes.
  void read_some(std::span<std::byte> bytes, Counted done);
  /// Writes the parts one after the other, at once where the system can.
  void write_parts(std::span<const std::span<const std::byte>> parts, Done done);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::net
