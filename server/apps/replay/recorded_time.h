#pragma once
// The times of a recording on one line. They are those of the server's clock, which may have been set while
// it recorded: time never runs backwards here, and no pause is longer than kLongestPause.
#include <chrono>
#include <cstdint>
#include <optional>

namespace obliq {

class RecordedTime {
 public:
  static constexpr std::chrono::seconds kLongestPause{300};

  /// For times in the order of the recording; in nanoseconds from the first one, which is at 0.
  std::int64_t at(std::int64_t utc_ns);

  /// What follows is from another place of the recording: its first time is at `at_ns`.
  void restart(std::int64_t at_ns);

  /// The recording begins again: its first time is as long after the last as that was after the one before
  /// it, or a second where there was none.
  void begin_again() { restart(at_ns_ + last_gap_ns_); }

 private:
  std::optional<std::int64_t> newest_utc_ns_;
  std::int64_t at_ns_ = 0;
  std::int64_t last_gap_ns_ = 1'000'000'000;
};

/// Between two times of a frame, which may be anything that was in a file: from 0 to kLongestPause.
std::int64_t recorded_gap_ns(std::int64_t earlier_utc_ns, std::int64_t later_utc_ns);

/// How long a recorded time takes at a speed; infinity: none.
std::chrono::steady_clock::duration played(std::int64_t recorded_ns, double speed);

/// When things are due that are replayed without a clock of their own, from the first on.
class DueTimes {
 public:
  using Clock = std::chrono::steady_clock;
  explicit DueTimes(double speed) : speed_(speed) {}
  Clock::time_point due(std::int64_t utc_ns) { return start_ + played(time_.at(utc_ns), speed_); }
  void begin_again() { time_.begin_again(); }

 private:
  double speed_;
  Clock::time_point start_ = Clock::now();
  RecordedTime time_;
};

}  // namespace obliq
