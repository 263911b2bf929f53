#pragma once
// One vertical profile, segment by segment: which range bins hold visible and which any known surface.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/simd/ground/profiles.h"
#include "server/radar/visibility/range_visibility.h"
#include "server/scene/tolerances.h"

namespace obliq {

/// Carries the running horizon outwards. Heights are relative to the antenna.
class RangeMarch {
 public:
  RangeMarch(const BinGrid& bins, double antenna_y_m, ProfileState<double>& state, BinMarks& result)
      : bins_(bins), antenna_y_m_(antenna_y_m), state_(state), result_(result) {}

  /// Surface y = start + rise d from d0 to d1; a rise from where the last segment ended is a wall.
  void segment(double start_m, double rise, double d0, double d1) {
    const double start = start_m - antenna_y_m_;
    const double h0 = start + rise * d0;
    // Rounding leaves steps of 1e-9 m where segments meet.
    if (state_.joined && h0 > state_.last_h_m + kTouching_m) wall(d0, state_.last_h_m, h0);
    state_.pass(true, start, rise, d0, d1, [&](bool where) {
      if (where) close(state_.visible, result_.visible);
    });
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
  ProfileState<double>& state_;
  BinMarks& result_;
};

/// One vertical profile: its roofs and how far it has come.
struct Profile {
  SinCos bearing;
  std::vector<RoofSpan> roofs;
  std::size_t roof = 0;
  ProfileState<double> state;
};

/// Hands the ground of one profile to the marcher, cut at footprint edges, with roofs on top.
class ProfileSurface {
 public:
  /// Begins at from_m. to_end: on to the profile's end, else no farther than the roofs that have begun.
  ProfileSurface(Profile& profile, RangeMarch& marcher, double from_m, bool to_end)
      : profile_(profile), marcher_(marcher), to_end_(to_end), from_m_(from_m), at_m_(from_m) {}

  void ground(const GroundSegment& segment) {
    const auto open = [&](double d0, double d1) { marcher_.segment(segment.start_m, segment.rise, d0, d1); };
    cut_at_roofs(profile_.roofs, profile_.roof, segment.d0_m, segment.d1_m, open,
                 [&](const RoofSpan& roof, double d0, double d1) {
                   over_roof(segment.start_m, segment.rise, roof.roof_y_m, d0, d1, open,
                             [&](double from, double to) { marcher_.segment(roof.roof_y_m, 0, from, to); });
                 });
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
  Profile& profile_;
  RangeMarch& marcher_;
  bool to_end_;
  double from_m_;
  double at_m_;
};

}  // namespace obliq
