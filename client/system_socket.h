#pragma once
// What a TCP connection needs of the operating system: the calls that POSIX and Windows name differently.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "client/status.h"

namespace obliq::client {

using Timeout = std::chrono::milliseconds;

/// A descriptor, or what Windows calls a SOCKET.
using SocketHandle = std::intptr_t;
constexpr SocketHandle kNoSocket = -1;

/// What came of one call: bytes, or an error's number.
struct Transfer {
  std::int64_t bytes = 0;  ///< below 0: the error says why; 0 of receive: the peer has closed
  int error = 0;

  bool may_retry() const;  ///< the socket does not block, and it would have
};

enum class Readiness { readable, writable };
enum class Awaited { ready, timed_out, failed };

/// A connected socket that does not block, to the first address of the host that answers; otherwise why not.
Status connect_socket(const std::string& host, std::uint16_t port, Timeout timeout, SocketHandle& out);
void close_socket(SocketHandle socket);

/// However often a signal interrupts it. error: of failed.
Awaited await_socket(SocketHandle socket, Readiness what, Timeout timeout, int& error);
/// A peer that has closed is an error, and no signal.
Transfer send_bytes(SocketHandle socket, std::span<const std::byte> bytes);
Transfer receive_bytes(SocketHandle socket, std::span<std::byte> bytes);

/// Of a number of Transfer or await_socket, in words.
std::string socket_error_text(int error);

/// An IPv4 or IPv6 address, and no name.
bool is_address(const std::string& host);

}  // namespace obliq::client
