#pragma once
// Ends of connections as operators read them.
#include <cstdint>
#include <string>

namespace obliq::net {

/// "127.0.0.1:7420", "[::1]:7420".
std::string endpoint_text(const std::string& host, std::uint16_t port);

/// Who is at the other end of a connected socket; "?" when the peer has gone already.
std::string host_of_peer(int socket);      ///< "127.0.0.1"
std::string endpoint_of_peer(int socket);  ///< "127.0.0.1:50000"

}  // namespace obliq::net
