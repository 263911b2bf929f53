#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "terrain/base/files.h"

namespace obliq {

/// What came, in order, with its time of arrival by two clocks.
struct Datagrams {
  struct One {
    std::size_t offset, size;
    std::chrono::steady_clock::time_point arrived;
    std::chrono::system_clock::time_point utc;
  };
  std::vector<std::byte> bytes;
  std::vector<One> all;

  std::span<const std::byte> of(const One& one) const {
    return std::span(bytes).subspan(one.offset, one.size);
  }
};

/// Empties a socket in a thread of its own, so that nothing is lost while its owner waits for a server.
class DatagramInbox {
 public:
  /// allowed: networks (server/security/networks.h) from which datagrams are taken; empty: from all.
  DatagramInbox(UniqueFd socket, std::vector<std::string> allowed);
  ~DatagramInbox();
  DatagramInbox(const DatagramInbox&) = delete;
  DatagramInbox& operator=(const DatagramInbox&) = delete;

  /// What has come; waits for so long where there is nothing.
  Datagrams take(std::chrono::milliseconds longest);

  /// Datagrams that were lost: by the kernel, whose buffer was full (SO_RXQ_OVFL), or here.
  std::uint64_t lost() const { return lost_; }
  /// From other networks.
  std::uint64_t not_allowed() const { return not_allowed_; }

 private:
  void run(const std::stop_token& stop);
  void receive(std::vector<std::byte>& buffer);
  bool is_allowed(std::uint32_t address);

  UniqueFd socket_;
  const std::vector<std::string> allowed_;
  std::mutex mutex_;
  std::condition_variable came_;
  Datagrams waiting_;  ///< by mutex_
  std::atomic<std::uint64_t> lost_{0}, not_allowed_{0};
  // Of the thread.
  std::uint32_t dropped_ = 0;
  std::uint32_t known_address_ = 0;
  bool known_is_allowed_ = false;
  std::jthread thread_;
};

}  // namespace obliq
