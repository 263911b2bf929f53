#pragma once
// Sends datagrams when they are due, in a thread of its own.
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/asterix/cat240_records.h"
#include "server/asterix/pace.h"
#include "server/asterix/udp_target.h"

namespace obliq::asterix {

struct SenderCounts {
  std::uint64_t sent = 0;
  std::uint64_t not_sent = 0;  ///< that the kernel did not take, or that were too many
  int error = 0;               ///< errno of the newest of these
};

class PacedSender {
 public:
  explicit PacedSender(UdpTarget target);
  /// What is not yet sent is dropped.
  ~PacedSender();

  /// Queues messages for those times. utc_ns: what their time of day says; none: when they are sent.
  void queue(std::vector<Bytes> messages, const Pace::Times& times, std::optional<std::int64_t> utc_ns);

  /// Waits until everything queued has been sent.
  void drain();

  SenderCounts counts() const;

 private:
  struct Due {
    Bytes message;
    Pace::Clock::time_point at;
    std::optional<std::int64_t> utc_ns;
  };
  void run(const std::stop_token& stop);
  std::vector<Bytes> take_due();
  void send(std::vector<Bytes>& messages);

  UdpTarget target_;
  mutable std::mutex mutex_;  ///< guards what follows, but for the thread
  std::condition_variable_any changed_;
  std::deque<Due> due_;
  std::size_t due_octets_ = 0;
  bool sending_ = false;
  SenderCounts counts_;
  std::jthread thread_;
};

}  // namespace obliq::asterix
