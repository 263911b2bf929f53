#pragma once
#include <chrono>
#include <cstdint>
#include <optional>

namespace obliq {

/// When things of a recording are due. The times in it are those of the server's clock, which may have been
/// set while it recorded: time never runs backwards here, and no pause is longer than kLongestPause.
class ReplayClock {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kLongestPause{300};

  /// speed: recorded seconds in a second; infinity: everything is due at once.
  explicit ReplayClock(double speed) : speed_(speed) {}

  /// For times in the order of the recording. The first one is due now.
  Clock::time_point due(std::int64_t utc_ns);

  /// The recording begins again: its first time is due as long after the last as that was after the one
  /// before it, or a second where there was none.
  void begin_again();

  /// The next time is due now: no client watched, and time stood still.
  void stand_still() { newest_ns_.reset(); }

  /// How long a recorded time takes here.
  Clock::duration scaled(std::int64_t recorded_ns) const;

 private:
  double speed_;
  std::optional<std::int64_t> newest_ns_;
  std::int64_t last_gap_ns_ = 1'000'000'000;
  Clock::time_point due_;
};

}  // namespace obliq
