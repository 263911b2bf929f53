#pragma once
// What all our TCP sockets need: their ends as operators read them, and an end to peers that have vanished.
#include <cstdint>
#include <string>

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

}  // namespace obliq::net
