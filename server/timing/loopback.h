#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>

#include "client/socket.h"
#include "terrain/base/files.h"

namespace obliq {

/// A TCP connection over the loopback, to a thread of this process that reads and drops. One thread sends at
/// a time.
class Loopback {
 public:
  /// Throws InputError where there is no loopback.
  Loopback();
  ~Loopback();
  Loopback(const Loopback&) = delete;
  Loopback& operator=(const Loopback&) = delete;

  /// Returns when the system has the bytes.
  void send(std::span<const std::byte> bytes);
  /// Returns when the reader has all that was sent.
  void drain() const;

 private:
  void read();

  UniqueFd reader_end_;
  client::Socket socket_;
  std::uint64_t sent_ = 0;
  std::atomic<std::uint64_t> received_{0};
  std::jthread reader_;  ///< last: it ends when the socket is closed
};

}  // namespace obliq
