#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/status.h"
#include "client/system_socket.h"
#include "client/tls.h"

namespace obliq::client {

struct Endpoint {
  std::string host;
  std::uint16_t port = 0;

  std::string text() const;
};

/// "HOST", "HOST:PORT", ":PORT", "PORT", "[IPv6]" or "[IPv6]:PORT"; without a port the default one, without a
/// host 127.0.0.1. Nothing if it is none of these.
std::optional<Endpoint> parse_endpoint(std::string_view text);

/// A TCP connection, with or without TLS, with deadlines: no call blocks for longer than its timeout without
/// progress. One thread at a time. Closed by the destructor.
class Socket {
 public:
  Socket() = default;
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;

  /// Tries each address of the host in turn.
  static Status connect(const Endpoint& endpoint, Timeout timeout, Socket& out);

  /// Before anything is sent: shakes hands with the host, whose certificate must be for that name. Fails with
  /// `untrusted` when the certificate does not hold or TLS is not spoken there.
  Status start_tls(const std::string& host, const TlsOptions& options, Timeout timeout);
  /// After start_tls has failed: goes on without TLS and hands back what the server has said in plain so far.
  std::vector<std::byte> give_up_tls();

  /// Sends all bytes or fails.
  Status send(std::span<const std::byte> bytes, Timeout timeout);
  /// Fills `bytes` or fails.
  Status receive(std::span<std::byte> bytes, Timeout timeout);
  /// Waits until a byte can be read or the peer has closed; timed_out when neither happens.
  Status wait_readable(Timeout timeout);

  bool is_open() const { return socket_ != kNoSocket; }
  void close();

 private:
  Status wait(Readiness what, Timeout timeout);
  Progress write_some(std::span<const std::byte> bytes);
  Progress read_some(std::span<std::byte> bytes);
  /// After progress that moved nothing: waits until there may be some, or says why there will be none.
  Status wait_for(const Progress& progress, Timeout timeout);

  SocketHandle socket_ = kNoSocket;
  std::unique_ptr<Tls> tls_;  ///< null: plain
};

}  // namespace obliq::client
