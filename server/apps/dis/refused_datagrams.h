#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace obliq {

/// Counts datagrams that are no pose, and says why in at most one line a second, whatever comes. A reason
/// that stays the same is told once.
class RefusedDatagrams {
 public:
  using Clock = std::chrono::steady_clock;

  void add(const std::string& why);
  /// What there is to say at this time; empty: nothing.
  std::string line(Clock::time_point now);
  /// What has not been said at the end.
  std::string rest();
  std::uint64_t all() const { return all_; }

 private:
  std::uint64_t all_ = 0;
  std::vector<std::pair<std::string, std::uint64_t>> waiting_;  ///< reasons, and of how many
  std::uint64_t waiting_others_ = 0;                            ///< for further reasons
  std::string newest_, told_;                                   ///< reasons
  Clock::time_point next_{};                                    ///< no line before
};

}  // namespace obliq
