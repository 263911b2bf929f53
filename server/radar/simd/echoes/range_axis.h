#pragma once
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

/// The range bins of the swath.
struct RangeAxis {
  int n_range = 0;
  double r_min_m = 0;
  double r_max_m = 0;
  double range_spacing_m = 0;

  /// Bin of a slant range: floor((r - r_min) / spacing), or -1 outside the swath.
  template <typename Real>
  OBLIQ_INLINE Real bin(Real slant_range_m) const {
    const Mask<Real> inside = (slant_range_m >= r_min_m) & (slant_range_m < r_max_m);
    const Real at =
        floor((select(inside, slant_range_m, broadcast<Real>(r_min_m)) - r_min_m) / range_spacing_m);
    return select(inside, min(at, broadcast<Real>(n_range - 1)), broadcast<Real>(-1));
  }
  OBLIQ_INLINE int range_bin(double slant_range_m) const { return static_cast<int>(bin(slant_range_m)); }

  /// Slant range of edge k, the nearer one of bin k; the last is r_max itself.
  template <typename Real>
  OBLIQ_INLINE Real edge_m(Real k) const {
    return select(k == static_cast<double>(n_range), broadcast<Real>(r_max_m), r_min_m + k * range_spacing_m);
  }
};

}  // namespace obliq
