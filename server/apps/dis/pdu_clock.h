#pragma once
#include <chrono>
#include <cstdint>
#include <optional>

namespace obliq {

/// Seconds past the hour of a timestamp of DIS: its upper 31 bits count 3600 s / 2^31 (IEEE 1278.1-2012,
/// 6.2.88). Empty where its lowest bit says that it counts from the sender's start.
std::optional<double> seconds_past_the_hour(std::uint32_t timestamp);

/// When what a PDU says was so, by this machine's monotonic clock: ownship and targets have one clock.
class PduClock {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Utc = std::chrono::system_clock::time_point;
  /// A sender whose clock differs by more from this machine's is not believed.
  static constexpr double kMost_s = 5;

  /// absolute: by its timestamp, where that is absolute and near; else by its arrival.
  explicit PduClock(bool absolute) : absolute_(absolute) {}

  /// arrived, utc: one moment by two clocks.
  Time moment(std::uint32_t timestamp, Time arrived, Utc utc);
  /// PDUs that were to be taken by their timestamps and were taken by their arrival.
  std::uint64_t arrivals() const { return arrivals_; }

 private:
  bool absolute_;
  std::uint64_t arrivals_ = 0;
};

}  // namespace obliq
