#pragma once
#include <algorithm>
#include <vector>

#include "server/radar/settings.h"
#include "server/radar/taper.h"

namespace obliq {

/// What the receiver makes of a point in range: a voltage p(r), real and even, 1 at the point. A rectangular
/// pulse of length tau after its matched filter: the triangle 1 - |r| / (c tau / 2). A compressed one: the
/// transform of its window over the bandwidth B. Immutable.
class PointResponse {
 public:
  explicit PointResponse(const RadarSettings& settings);

  double at(double offset_m) const;
  /// c / 2B, or c tau / 2: no range bin may be longer. Infinite when off.
  double resolution_m() const { return resolution_m_; }
  /// Integral of p^2: the length of a box that sees as much ground. 0 when off.
  double equivalent_length_m() const;
  /// What the window loses of a target over noise, dB.
  double window_loss_db() const;
  /// c tau / 2: nearer echoes are cut by the transmission itself.
  double half_pulse_m() const { return half_pulse_m_; }
  /// What the transmission leaves of the voltage of an echo from there, where it cuts echoes.
  double left_by_eclipse(double range_m) const { return std::min(1.0, range_m / half_pulse_m_); }

  /// Bins of that length on either side beyond which p is 0: of a triangle those that it reaches, of a
  /// compressed pulse extent_bins, which cuts it off.
  int reach_bins(double bin_m, int extent_bins) const;

  /// The filter's weights h_j, j = -J .. J, for bins of that length; {1} when off. Those of a compressed
  /// pulse are p itself. The triangle has no limited band: its samples, scaled so that the sum of their
  /// squares gives level ground the power of the whole triangle (2/3 c tau/2), which takes 10 log10(1 + 1 /
  /// 2n^2) dB from a point in the middle of a bin, n bins in c tau / 2.
  std::vector<double> kernel(double bin_m, int extent_bins) const;

 private:
  PulseKind kind_;
  double resolution_m_;
  double half_pulse_m_;
  Taper taper_;
};

}  // namespace obliq
