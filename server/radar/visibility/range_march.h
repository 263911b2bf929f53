#pragma once
// One vertical profile, piece by piece: which range bins hold visible and which any known surface.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "server/radar/simd/visible_ranges.h"
#include "server/radar/visibility/range_visibility.h"

namespace obliq {

/// Marks the range bins that a connected stretch of profile covers. Slant range is continuous along it, so
/// its least and greatest range are enough, and they need one square root each for the whole stretch.
class RangeRun {
 public:
  RangeRun(double& least2, double& greatest2) : least2_(least2), greatest2_(greatest2) {}

  void add(double d, double h) {
    const double r2 = d * d + h * h;
    least2_ = std::min(least2_, r2);
    greatest2_ = std::max(greatest2_, r2);
  }
  /// A straight piece; the foot of the perpendicular from the antenna may lie on it, nearer than both ends.
  void add(double d0, double h0, double d1, double h1) {
    add(d0, h0);
    add(d1, h1);
    const double dd = d1 - d0;
    const double dh = h1 - h0;
    const double along = -(d0 * dd + h0 * dh);
    if (along <= 0) return;
    const double length2 = dd * dd + dh * dh;
    if (along >= length2) return;
    const double cross = d0 * dh - h0 * dd;
    least2_ = std::min(least2_, cross * cross / length2);
  }
  void close(const BinGrid& bins, std::vector<std::uint8_t>& plane) {
    if (greatest2_ >= 0) {
      const double low = std::sqrt(least2_);
      const double high = std::sqrt(greatest2_);
      if (high >= bins.r_min_m && low < bins.r_max_m) {
        const int last = high >= bins.r_max_m ? bins.n_range - 1 : bins.range_bin(high);
        for (int bin = low < bins.r_min_m ? 0 : bins.range_bin(low); bin <= last; ++bin)
          plane[static_cast<std::size_t>(bin)] = 1;
      }
    }
    least2_ = std::numeric_limits<double>::infinity();
    greatest2_ = -1;
  }

 private:
  double& least2_;
  double& greatest2_;  // negative: empty
};

/// Carries the running horizon outwards. Heights are relative to the antenna. The horizon is kept as the
/// point (horizon_d, horizon_h) that set it: slopes are compared by cross products, without a division.
class ProfileMarch {
 public:
  ProfileMarch(const BinGrid& bins, double antenna_y_m, ProfileState& state, ProfileResult& result)
      : bins_(bins),
        antenna_y_m_(antenna_y_m),
        state_(state),
        visible_(state.visible_least2, state.visible_greatest2),
        present_(state.present_least2, state.present_greatest2),
        result_(result) {}

  /// Surface from (d0, y0) to (d1, y1); a rise from where the last piece ended is a wall.
  void piece(double d0, double y0, double d1, double y1) {
    const double h0 = y0 - antenna_y_m_;
    const double h1 = y1 - antenna_y_m_;
    // Rounding leaves steps of 1e-9 m where pieces meet.
    if (state_.joined != 0 && h0 > state_.last_h_m + 1e-6) wall(d0, state_.last_h_m, h0);
    present_.add(d0, h0, d1, h1);
    if (hidden(d1, h1)) {
      end_visible();
      if (!hidden(d0, h0)) set_horizon(d0, h0);
    } else if (h1 * d0 > h0 * d1) {  // rising in elevation: its upper side faces the antenna
      if (hidden(d0, h0)) {
        // Where the piece comes out of the shadow: h(d) = horizon d.
        end_visible();
        const double rise = (h1 - h0) / (d1 - d0);
        const double from =
            std::clamp((h0 - rise * d0) / (state_.horizon_h_m / state_.horizon_d_m - rise), d0, d1);
        visible_.add(from, h0 + rise * (from - d0), d1, h1);
      } else {
        visible_.add(d0, h0, d1, h1);
      }
      set_horizon(d1, h1);
    } else {  // falls away: seen at its near edge only
      end_visible();
      set_horizon(d0, h0);
    }
    state_.joined = 1;
    state_.last_h_m = h1;
  }

  /// No surface follows; the next piece starts without a wall.
  void gap() {
    end_visible();
    present_.close(bins_, result_.present);
    state_.joined = 0;
  }

 private:
  /// Strictly below the horizon. At the start the horizon is straight down, (0, -1): nothing is below it.
  bool hidden(double d, double h) const { return h * state_.horizon_d_m < state_.horizon_h_m * d; }

  void set_horizon(double d, double h) {
    if (!(d > 0)) return;
    state_.horizon_d_m = d;
    state_.horizon_h_m = h;
  }

  void end_visible() { visible_.close(bins_, result_.visible); }

  void wall(double d, double low, double high) {
    present_.add(d, low);
    if (hidden(d, high)) return;
    end_visible();
    visible_.add(d, state_.horizon_d_m > 0 ? std::max(low, state_.horizon_h_m / state_.horizon_d_m * d) : low,
                 d, high);
    set_horizon(d, high);
  }

  const BinGrid& bins_;
  double antenna_y_m_;
  ProfileState& state_;
  RangeRun visible_;
  RangeRun present_;
  ProfileResult& result_;
};

}  // namespace obliq
