#include "server/apps/replay/recorded_time.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

constexpr std::int64_t kLongestPause_ns = std::chrono::nanoseconds(RecordedTime::kLongestPause).count();
// Messages are encoded on several threads: so little backwards is not a clock that was set.
constexpr std::int64_t kJitter_ns = 1'000'000'000;

/// later - earlier, where both may be anything that was in a file.
std::int64_t difference_ns(std::int64_t later, std::int64_t earlier) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(later, earlier, &difference)) return later > earlier ? INT64_MAX : INT64_MIN;
  return difference;
}

}  // namespace

std::int64_t RecordedTime::at(std::int64_t utc_ns) {
  if (!newest_utc_ns_) {
    newest_utc_ns_ = utc_ns;
    return at_ns_;
  }
  const std::int64_t gap_ns = difference_ns(utc_ns, *newest_utc_ns_);
  if (gap_ns > 0) {
    last_gap_ns_ = std::min(gap_ns, kLongestPause_ns);
    at_ns_ += last_gap_ns_;
  }
  if (gap_ns > 0 || gap_ns < -kJitter_ns) newest_utc_ns_ = utc_ns;
  return at_ns_;
}

void RecordedTime::restart(std::int64_t at_ns) {
  newest_utc_ns_.reset();
  at_ns_ = at_ns;
}

std::int64_t recorded_gap_ns(std::int64_t earlier_utc_ns, std::int64_t later_utc_ns) {
  return std::clamp<std::int64_t>(difference_ns(later_utc_ns, earlier_utc_ns), 0, kLongestPause_ns);
}

std::chrono::steady_clock::duration played(std::int64_t recorded_ns, double speed) {
  if (!std::isfinite(speed)) return {};
  constexpr double kMost_ns = 1e18;  // 30 years, far from where the clock's numbers end
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double, std::nano>(std::min(static_cast<double>(recorded_ns) / speed, kMost_ns)));
}

}  // namespace obliq
