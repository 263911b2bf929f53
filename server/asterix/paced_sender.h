#pragma once
// Sends datagrams when they are due, in a thread of its own.
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/asterix/cat240_records.h"
#include "server/asterix/udp_target.h"

namespace obliq::asterix {

/// For one thread at a time.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// Times of so many datagrams that came at `now`, the next ones following after about `period`: evenly up
  /// to then, behind those of before. Where these are late, the new ones come closer to each other, at most
  /// four times as close.
  struct Times {
    Clock::time_point first;
    Clock::duration step{};
    Clock::time_point at(std::size_t i) const { return first + step * static_cast<Clock::rep>(i); }
  };
  Times spread(Clock::time_point now, std::size_t datagrams, Clock::duration period);

 private:
  Clock::time_point free_from_{};
};

/// How far apart the frames of a radar are: as the last ones came, but neither closer than was asked for nor
/// as far as a single pause. For one thread at a time.
class FramePeriod {
 public:
  explicit FramePeriod(double rate_hz);
  /// A frame is complete.
  Pace::Clock::duration next(Pace::Clock::time_point now);

 private:
  Pace::Clock::duration asked_;
  Pace::Clock::duration before_;
  Pace::Clock::time_point newest_{};
};

/// How far apart the dwells of a scanning antenna come: as the beam moves; closer together, where a replay is
/// faster than the antenna was. For one thread at a time.
class DwellPeriod {
 public:
  /// Azimuth bins have come for which the beam took so long.
  Pace::Clock::duration next(Pace::Clock::time_point now, Pace::Clock::duration beam);

 private:
  double part_ = 1;  ///< of the beam's time, a mean over the last dwells
  Pace::Clock::time_point newest_{};
};

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
