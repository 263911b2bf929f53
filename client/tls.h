#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/system_socket.h"

namespace obliq::client {

struct TlsOptions {
  bool enabled = false;
  std::string ca_file{};  ///< PEM of the trusted authorities; empty: this machine's
};

/// What came of trying to send, receive or shake hands without blocking.
struct Progress {
  enum class Kind { moved, wants_read, wants_write, ended, failed };
  Kind kind = Kind::moved;
  std::size_t bytes = 0;
  std::string reason{};  ///< failed
};

/// TLS 1.2 or later over a connected socket that does not block, which stays the caller's. The server must
/// show a certificate for the host's name or address. One thread at a time.
class Tls {
 public:
  /// Null when the ca_file is no such file: the reason is then in `failure`.
  static std::unique_ptr<Tls> make(SocketHandle socket, const std::string& host, const TlsOptions& options,
                                   std::string& failure);
  ~Tls();
  Tls(const Tls&) = delete;
  Tls& operator=(const Tls&) = delete;

  Progress shake_hands();
  Progress write(std::span<const std::byte> bytes);
  Progress read(std::span<std::byte> bytes);
  /// moved: there is something to read.
  Progress peek();
  /// The first bytes of a server that turned out not to speak TLS.
  const std::vector<std::byte>& first_bytes() const;

 private:
  struct State;
  explicit Tls(std::unique_ptr<State> state);
  Progress progress(int result);
  std::unique_ptr<State> state_;
};

}  // namespace obliq::client
