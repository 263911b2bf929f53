#include "server/apps/dis/pdu_clock.h"

#include <cmath>

namespace obliq {
namespace {

constexpr double kHour_s = 3600;

}  // namespace

std::optional<double> seconds_past_the_hour(std::uint32_t timestamp) {
  constexpr double kUnits = 2147483648.0;  // of an hour
  if ((timestamp & 1) == 0) return std::nullopt;
  return static_cast<double>(timestamp >> 1) * (kHour_s / kUnits);
}

PduClock::Time PduClock::moment(std::uint32_t timestamp, Time arrived, Utc utc) {
  if (!absolute_) return arrived;
  if (const auto said_s = seconds_past_the_hour(timestamp)) {
    const std::chrono::duration<double> since_1970 = utc.time_since_epoch();
    // The hour may end between the two.
    const double ahead_s = std::remainder(*said_s - std::fmod(since_1970.count(), kHour_s), kHour_s);
    if (std::abs(ahead_s) <= kMost_s)
      return arrived + std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(ahead_s));
  }
  ++arrivals_;
  return arrived;
}

}  // namespace obliq
