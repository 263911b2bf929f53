#pragma once
// When datagrams are due: as evenly as what brings them allows, so that no burst overruns a receiver's
// buffer, and never more than a frame behind.
#include <chrono>
#include <cstddef>

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

}  // namespace obliq::asterix
