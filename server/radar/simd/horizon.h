#pragma once
#include "server/radar/simd/lanes.h"

namespace obliq {

/// The highest elevation that anything up to some distance has, kept as the point (d, h) that reaches it, h
/// above the antenna: slopes are compared by cross products, without a division. In kernels it is initialised
/// member by member, for its constructor would not be inlined.
template <typename Real>
struct Horizon {
  Real d_m{};
  Real h_m = Real{} - 1.0;  ///< straight down: nothing lies below it
  Mask<Real> building{};    ///< a building reaches it

  /// Strictly below the horizon.
  OBLIQ_INLINE Mask<Real> hides(Real d, Real h) const { return h * d_m < h_m * d; }

  OBLIQ_INLINE void raise(Real d, Real h, Mask<Real> by_building) {
    set((d > 0.0) & inverse(hides(d, h)), d, h, by_building);
  }

  /// What the horizon leaves of a segment up to its far end: nothing, or all from `from` on.
  struct Seen {
    Mask<Real> any;
    Real from;
  };

  /// Passes a segment h = start + rise d of sloping surface from d0 to d1. It faces the antenna when that is
  /// above its plane (start < 0): then elevation rises along it.
  OBLIQ_INLINE Seen pass(Mask<Real> where, Real start, Real rise, Real d0, Real d1, Mask<Real> by_building) {
    const Real h0 = start + rise * d0;
    const Real h1 = start + rise * d1;
    const Mask<Real> facing = where & (start < 0.0);
    const Mask<Real> falls = inverse(facing);
    const Mask<Real> hides0 = hides(d0, h0);
    const Mask<Real> shows0 = inverse(hides0);
    // Where it comes out of the shadow: start + rise d = (h / d of the horizon) d.
    const Real out = clamp(start * d_m / (h_m - rise * d_m), d0, d1);
    Seen seen;
    seen.from = select(hides0, out, d0);
    const Mask<Real> rises = facing & inverse(hides(d1, h1));
    seen.any = rises & (seen.from < d1);
    set(where & falls & (d0 > 0.0) & shows0, d0, h0, by_building);
    set(rises, d1, h1, by_building);
    return seen;
  }

  /// What it leaves of segments of any slope, by their ends.
  struct Rising {
    Mask<Real> rises;    ///< above the horizon, up to the far end;
    Mask<Real> emerges;  ///< of those, the ones that begin below it come out at (from_d, from_h)
    Real from_d, from_h;
  };

  /// Passes a segment from (d0, h0) to (d1, h1). One that falls in elevation is seen at its near end only.
  OBLIQ_INLINE Rising pass_ends(Mask<Real> where, Real d0, Real h0, Real d1, Real h1) {
    const Mask<Real> hides0 = hides(d0, h0);
    const Mask<Real> hides1 = hides(d1, h1);
    Rising at;
    at.rises = where & inverse(hides1) & (h1 * d0 > h0 * d1);
    at.emerges = at.rises & hides0;
    at.from_d = d0;
    at.from_h = h0;
    if (any(at.emerges)) {
      // Where it comes out of the shadow: h(d) = horizon d.
      const Real slope = (h1 - h0) / (d1 - d0);
      at.from_d = clamp((h0 - slope * d0) / (h_m / d_m - slope), d0, d1);
      at.from_h = h0 + slope * (at.from_d - d0);
    }
    const Mask<Real> falls = inverse(at.rises);
    const Mask<Real> shows = inverse(hides1 & hides0);
    const Mask<Real> near = where & falls & shows & (d0 > 0.0);
    set(near, d0, h0, building);
    set(at.rises & (d1 > 0.0), d1, h1, building);
    return at;
  }

 private:
  OBLIQ_INLINE void set(Mask<Real> where, Real d, Real h, Mask<Real> by_building) {
    d_m = select(where, d, d_m);
    h_m = select(where, h, h_m);
    building = select(where, by_building, building);
  }
};

}  // namespace obliq
