#pragma once
#include "server/radar/simd/lanes/lanes.h"

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
    Mask<Real> emerges;  ///< of those: hidden up to `from`
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
    const Mask<Real> rises = facing & inverse(hides(d1, h1));
    Seen seen;
    seen.from = d0;
    seen.emerges = rises & hides0;
    // Where it comes out of the shadow: start + rise d = (h / d of the horizon) d.
    if (any(seen.emerges)) seen.from = select(hides0, clamp(start * d_m / (h_m - rise * d_m), d0, d1), d0);
    seen.any = rises & (seen.from < d1);
    seen.emerges = seen.emerges & seen.any;
    set(where & falls & (d0 > 0.0) & shows0, d0, h0, by_building);
    set(rises, d1, h1, by_building);
    return seen;
  }

 private:
  OBLIQ_INLINE void set(Mask<Real> where, Real d, Real h, Mask<Real> by_building) {
    d_m = select(where, d, d_m);
    h_m = select(where, h, h_m);
    building = select(where, by_building, building);
  }
};

}  // namespace obliq
