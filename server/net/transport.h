#pragma once
// The bytes of one connection, through TLS where the server has it: what the session reads and writes.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace boost::asio {
class io_context;
namespace ssl {
class context;
}
}  // namespace boost::asio

namespace obliq::net {

/// On the io thread. One reader and one writer at a time; `done` is called later, and until then the
/// transport and the bytes must live.
class Transport {
 public:
  enum class Start {
    ready,
    plain_peer,  ///< the peer does not speak TLS where it must: what follows is sent in plain
    failed,
  };
  enum class Transfer { done, end, failed };  ///< end: the peer has closed
  using Started = std::function<void(Start)>;
  using Done = std::function<void(Transfer)>;

  /// Takes the connected socket. tls null: plain.
  Transport(boost::asio::io_context& io, int socket_fd, bool is_ipv6,
            std::shared_ptr<boost::asio::ssl::context> tls);
  ~Transport();
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// "127.0.0.1" (to a listener of IPv6 "::ffff:127.0.0.1"), or "?" when the peer has gone already.
  std::string host() const;
  std::string address() const;  ///< "127.0.0.1:50000"

  /// First of all. Has no time limit of its own: close() ends it.
  void start(Started done);
  bool is_ready() const;
  /// Why start() failed; of a session that runs, its TLS version and cipher; "plain" without TLS.
  std::string description() const;

  /// Fills the buffer, or with `some` a part of it.
  void read(std::span<std::byte> bytes, bool some, Done done);
  void write(std::span<const std::byte> bytes, Done done);
  /// Tells the peer that nothing more comes, after everything has been written.
  void finish(Done done);
  /// Ends all of the above at once.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::net
