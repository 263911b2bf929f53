#pragma once
#include <chrono>
#include <cstddef>
#include <span>

#include "client/endpoint.h"
#include "client/status.h"

namespace obliq::client {

using Timeout = std::chrono::milliseconds;

/// A TCP connection with deadlines: no call blocks for longer than its timeout without progress. One thread
/// at a time. Closed by the destructor.
class Socket {
 public:
  Socket() = default;
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;

  /// Tries each address of the host in turn.
  static Status connect(const Endpoint& endpoint, Timeout timeout, Socket& out);

  /// Sends all bytes or fails.
  Status send(std::span<const std::byte> bytes, Timeout timeout);
  /// Fills `bytes` or fails.
  Status receive(std::span<std::byte> bytes, Timeout timeout);
  /// Waits until a byte can be read or the peer has closed; timed_out when neither happens.
  Status wait_readable(Timeout timeout);

  bool is_open() const { return fd_ >= 0; }
  void close();

 private:
  Status wait(short events, Timeout timeout);

  int fd_ = -1;
};

}  // namespace obliq::client
