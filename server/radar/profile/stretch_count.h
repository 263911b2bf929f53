#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "server/radar/simd/echoes/range_axis.h"

namespace obliq {

/// Follows the visible surface of one vertical plane outwards, and counts how often it comes into each range
/// bin: Labels::returns of the plane.
class StretchCount {
 public:
  explicit StretchCount(const RangeAxis& bins)
      : bins_(&bins), count_(static_cast<std::size_t>(bins.n_range)) {}

  /// What comes next is not joined to what was seen last.
  void leave() { bin_ = kNone; }
  /// The surface is in a range bin.
  void enter(int bin) {
    if (bin == bin_) return;
    bin_ = bin;
    if (bin < 0 || bin >= bins_->n_range) return;
    std::uint8_t& count = count_[static_cast<std::size_t>(bin)];
    if (count < 255) ++count;
  }
  void enter_at(double range_m) { enter(bin_at(range_m)); }
  /// It goes on to a range, through all between.
  void go_to(double range_m) {
    for (const int last = bin_at(range_m); bin_ != last;) enter(bin_ < last ? bin_ + 1 : bin_ - 1);
  }

  /// Raises the most of several planes, [n_range].
  void raise(std::uint8_t* most) const {
    for (const std::uint8_t count : count_) {
      *most = std::max(*most, count);
      ++most;
    }
  }
  void restart() {
    leave();
    std::ranges::fill(count_, 0);
  }

 private:
  static constexpr int kNone = -2;
  /// -1: nearer than the swath, n_range: beyond it.
  int bin_at(double range_m) const {
    const double at = std::floor((range_m - bins_->r_min_m) / bins_->range_spacing_m);
    return static_cast<int>(std::clamp(at, -1.0, static_cast<double>(bins_->n_range)));
  }

  const RangeAxis* bins_;
  std::vector<std::uint8_t> count_;
  int bin_ = kNone;
};

}  // namespace obliq
