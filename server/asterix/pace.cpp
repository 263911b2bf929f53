#include "server/asterix/pace.h"

#include <algorithm>

#include "terrain/base/units.h"

namespace obliq::asterix {

namespace {
constexpr int kMostSqueezed = 4;
}

Pace::Times Pace::spread(Clock::time_point now, std::size_t datagrams, Clock::duration period) {
  const auto first = std::max(now, free_from_);
  free_from_ = std::max(now + period, first + period / kMostSqueezed);
  const auto n = static_cast<Clock::rep>(std::max<std::size_t>(datagrams, 1));
  return {first, (free_from_ - first) / n};
}

FramePeriod::FramePeriod(double rate_hz) : asked_(from_seconds(1 / rate_hz)), before_(asked_) {}

Pace::Clock::duration FramePeriod::next(Pace::Clock::time_point now) {
  const auto since = newest_ == Pace::Clock::time_point{} ? asked_ : std::max(now - newest_, asked_);
  newest_ = now;
  // Of two: one long pause says nothing about the next.
  const auto period = std::min(since, before_);
  before_ = since;
  return period;
}

Pace::Clock::duration DwellPeriod::next(Pace::Clock::time_point now, Pace::Clock::duration beam) {
  constexpr double kMost = 10;     // a pause is no slow beam
  constexpr double kNewest = 0.2;  // of the mean: dwells that come bunched do not count as fast ones
  if (newest_ != Pace::Clock::time_point{} && beam.count() > 0) {
    const double part = std::chrono::duration<double>(now - newest_) / std::chrono::duration<double>(beam);
    part_ += kNewest * (std::min(part, kMost) - part_);
  }
  newest_ = now;
  return from_seconds(std::min(part_, 1.0) * to_seconds(beam));
}

}  // namespace obliq::asterix
