#include "server/apps/replay/replay_clock.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

constexpr std::int64_t kLongestPause_ns = std::chrono::nanoseconds(ReplayClock::kLongestPause).count();
// Messages are encoded on several threads: so little backwards is not a clock that was set.
constexpr std::int64_t kJitter_ns = 1'000'000'000;

/// later - earlier, where both may be anything that was in a file.
std::int64_t difference_ns(std::int64_t later, std::int64_t earlier) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(later, earlier, &difference)) return later > earlier ? INT64_MAX : INT64_MIN;
  return difference;
}

}  // namespace

ReplayClock::Clock::duration ReplayClock::scaled(std::int64_t recorded_ns) const {
  if (!std::isfinite(speed_)) return {};
  const double ns = static_cast<double>(std::clamp<std::int64_t>(recorded_ns, 0, kLongestPause_ns)) / speed_;
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::nano>(ns));
}

void ReplayClock::begin_again() {
  newest_ns_.reset();
  due_ += scaled(last_gap_ns_);
}

ReplayClock::Clock::time_point ReplayClock::due(std::int64_t utc_ns) {
  if (!newest_ns_) {
    newest_ns_ = utc_ns;
    return due_ = std::max(due_, Clock::now());
  }
  const std::int64_t gap_ns = difference_ns(utc_ns, *newest_ns_);
  if (gap_ns > 0) {
    due_ += scaled(gap_ns);
    last_gap_ns_ = gap_ns;
  }
  if (gap_ns > 0 || gap_ns < -kJitter_ns) newest_ns_ = utc_ns;
  return due_;
}

}  // namespace obliq
