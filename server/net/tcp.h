#pragma once
// What all our TCP sockets need: their ends as operators read them, and an end to peers that have vanished.
#include <cstdint>
#include <string>

#include "terrain/base/files.h"

namespace obliq::net {

/// "127.0.0.1:7420", "[::1]:7420".
std::string endpoint_text(const std::string& host, std::uint16_t port);

/// The other end of a connected socket; "?" when the peer has gone already.
std::string host_of_peer(int socket);      ///< "127.0.0.1"
std::string endpoint_of_peer(int socket);  ///< "127.0.0.1:50000"

/// A peer that has vanished without closing (its machine lost power, a cable was pulled) is given up after
/// `dead_after_s` without a sign of life from its machine, whether or not anything waits to be sent to it:
/// TCP_KEEPIDLE, TCP_KEEPINTVL, TCP_KEEPCNT and TCP_USER_TIMEOUT (tcp(7)). Rounded to whole seconds, from
/// kMinDeadAfter_s to kMaxDeadAfter_s. False when the system refuses; the connection works without.
bool watch_for_dead_peer(int socket_fd, double dead_after_s);

constexpr int kMinDeadAfter_s = 4;
constexpr int kMaxDeadAfter_s = 3600;  // Linux takes at most 32767 s for each of its parts

/// A TCP address taken for a server that is not ready yet: bound, so that a port in use is known before
/// anything is loaded, but not listened on, so that clients are refused at once instead of left waiting.
/// Of two that load at the same time the second to listen fails.
class ReservedPort {
 public:
  /// Port 0: any free one. Throws InputError when the address is unknown or the port in use.
  ReservedPort(const std::string& address, std::uint16_t port);

  bool is_v6() const { return is_v6_; }
  const std::string& address() const { return address_; }  ///< "127.0.0.1:7420"
  /// The bound socket, which is the caller's from now on.
  int release() { return fd_.release(); }

 private:
  UniqueFd fd_;
  bool is_v6_ = false;
  std::string address_;
};

}  // namespace obliq::net
