#pragma once
// One vertical profile, segment by segment: which range bins hold visible and which any known surface.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/simd/visible_ranges.h"
#include "server/radar/visibility/range_visibility.h"
#include "server/scene/tolerances.h"

namespace obliq {

/// Carries the running horizon outwards. Heights are relative to the antenna.
class RangeMarch {
 public:
  RangeMarch(const BinGrid& bins, double antenna_y_m, ProfileState& state, BinMarks& result)
      : bins_(bins), antenna_y_m_(antenna_y_m), state_(state), result_(result) {}

  /// Surface from (d0, y0) to (d1, y1); a rise from where the last segment ended is a wall.
  void segment(double d0, double y0, double d1, double y1) {
    const double h0 = y0 - antenna_y_m_;
    const double h1 = y1 - antenna_y_m_;
    // Rounding leaves steps of 1e-9 m where segments meet.
    if (state_.joined && h0 > state_.last_h_m + kTouching_m) wall(d0, state_.last_h_m, h0);
    const RangeRun<double> ranges = ranges_of(true, d0, h0, d1, h1);
    state_.present.add(true, ranges);
    const auto [rises, emerges, from_d, from_h] = state_.horizon.pass_ends(true, d0, h0, d1, h1);
    if (!rises || emerges) close(state_.visible, result_.visible);
    if (rises) state_.visible.add(true, emerges ? ranges_of(true, from_d, from_h, d1, h1) : ranges);
    state_.joined = true;
    state_.last_h_m = h1;
  }

  /// No surface follows; the next segment starts without a wall.
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
  BinMarks& result_;
};

/// One vertical profile: its roofs and how far it has come.
struct Profile {
  SinCos bearing;
  std::vector<RoofSpan> roofs;
  std::size_t roof = 0;
  ProfileState state;
};

/// Hands the ground of one profile to the marcher, cut at footprint edges, with roofs on top.
class ProfileSurface {
 public:
  /// Begins at from_m. to_end: on to the profile's end, else no farther than the roofs that have begun.
  ProfileSurface(Profile& profile, RangeMarch& marcher, double from_m, bool to_end)
      : profile_(profile), marcher_(marcher), to_end_(to_end), from_m_(from_m), at_m_(from_m) {}

  void ground(const GroundSegment& segment) {
    if (profile_.roof < profile_.roofs.size()) {
      with_roofs(segment.d0_m, segment.d1_m, segment.start_m, segment.rise);
    } else {
      marcher_.segment(segment.d0_m, segment.start_m + segment.rise * segment.d0_m, segment.d1_m,
                       segment.start_m + segment.rise * segment.d1_m);
    }
    at_m_ = segment.d1_m;
  }
  void gap(double /*d0*/, double d1) {
    marcher_.gap();
    at_m_ = d1;
  }
  bool enough() {
    // The first cell may be one that ends where the walk begins.
    if (to_end_ || !(at_m_ > from_m_)) return false;
    while (profile_.roof < profile_.roofs.size() && profile_.roofs[profile_.roof].far_m <= at_m_)
      ++profile_.roof;
    return profile_.roof == profile_.roofs.size() || profile_.roofs[profile_.roof].near_m > at_m_;
  }

 private:
  /// Ground y = start + rise d on [d0, d1], replaced by roofs that stand above it.
  void with_roofs(double d0, double d1, double start, double rise) {
    const std::vector<RoofSpan>& roofs = profile_.roofs;
    std::size_t& at = profile_.roof;
    double d = d0;
    while (d < d1) {
      while (at < roofs.size() && roofs[at].far_m <= d) ++at;
      double end = d1;
      bool roofed = false;
      if (at < roofs.size()) {
        roofed = roofs[at].near_m <= d;
        end = std::min(end, roofed ? roofs[at].far_m : roofs[at].near_m);
      }
      const double y0 = start + rise * d;
      const double y1 = start + rise * end;
      const double roof = roofed ? roofs[at].roof_y_m : -std::numeric_limits<double>::infinity();
      marcher_.segment(d, std::max(y0, roof), end, std::max(y1, roof));
      d = end;
    }
  }

  Profile& profile_;
  RangeMarch& marcher_;
  bool to_end_;
  double from_m_;
  double at_m_;
};

}  // namespace obliq
