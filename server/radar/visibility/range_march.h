#pragma once
// One vertical profile, piece by piece: which range bins hold visible and which any known surface.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "server/radar/simd/visible_ranges.h"
#include "server/radar/visibility/range_visibility.h"

namespace obliq {

/// Carries the running horizon outwards. Heights are relative to the antenna.
class ProfileMarch {
 public:
  ProfileMarch(const BinGrid& bins, double antenna_y_m, ProfileState& state, ProfileResult& result)
      : bins_(bins), antenna_y_m_(antenna_y_m), state_(state), result_(result) {}

  /// Surface from (d0, y0) to (d1, y1); a rise from where the last piece ended is a wall.
  void piece(double d0, double y0, double d1, double y1) {
    const double h0 = y0 - antenna_y_m_;
    const double h1 = y1 - antenna_y_m_;
    // Rounding leaves steps of 1e-9 m where pieces meet.
    if (state_.joined && h0 > state_.last_h_m + 1e-6) wall(d0, state_.last_h_m, h0);
    const RangeRun<double> ranges = ranges_of(true, d0, h0, d1, h1);
    state_.present.add(true, ranges);
    const auto [rises, emerges, from_d, from_h] = state_.horizon.pass_ends(true, d0, h0, d1, h1);
    if (!rises || emerges) close(state_.visible, result_.visible);
    if (rises) state_.visible.add(true, emerges ? ranges_of(true, from_d, from_h, d1, h1) : ranges);
    state_.joined = true;
    state_.last_h_m = h1;
  }

  /// No surface follows; the next piece starts without a wall.
  void gap() {
    close(state_.visible, result_.visible);
    close(state_.present, result_.present);
    state_.joined = false;
  }

 private:
  /// Marks the bins of a run and empties it.
  void close(RangeRun<double>& run, std::vector<std::uint8_t>& marks) const {
    if (run.greatest2 >= 0) mark_bins(bins_, std::sqrt(run.least2), std::sqrt(run.greatest2), marks.data());
    run.clear(true);
  }

  void wall(double d, double low, double high) {
    const Horizon<double>& horizon = state_.horizon;
    state_.present.add(true, ranges_of(true, d, low, d, low));
    if (horizon.hides(d, high)) return;
    close(state_.visible, result_.visible);
    const double foot = horizon.d_m > 0 ? std::max(low, horizon.h_m / horizon.d_m * d) : low;
    state_.visible.add(true, ranges_of(true, d, foot, d, high));
    state_.horizon.raise(d, high, false);
  }

  const BinGrid& bins_;
  double antenna_y_m_;
  ProfileState& state_;
  ProfileResult& result_;
};

}  // namespace obliq
