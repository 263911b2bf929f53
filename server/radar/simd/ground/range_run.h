#pragma once
// Slant range along straight segments of a profile.
#include "server/radar/simd/echoes/range_axis.h"

namespace obliq {

/// Squares of the least and the greatest slant range of a connected stretch of profile, which covers the
/// range bins between: slant range is continuous along it. One square root each is enough for the whole
/// stretch.
template <typename Real>
struct RangeRun {
  Real least2 = Real{} + __builtin_inf();
  Real greatest2 = Real{} - 1.0;  ///< negative: no stretch

  OBLIQ_INLINE void add(Mask<Real> where, const RangeRun& ranges) {
    least2 = select(where, min(least2, ranges.least2), least2);
    greatest2 = select(where, max(greatest2, ranges.greatest2), greatest2);
  }
  OBLIQ_INLINE void clear(Mask<Real> where) {
    least2 = select(where, broadcast<Real>(__builtin_inf()), least2);
    greatest2 = select(where, broadcast<Real>(-1), greatest2);
  }
};

/// Of straight segments. The foot of the perpendicular from the antenna may lie on one, nearer than both
/// ends.
template <typename Real>
OBLIQ_INLINE RangeRun<Real> ranges_of(Mask<Real> where, Real d0, Real h0, Real d1, Real h1) {
  const Real first2 = d0 * d0 + h0 * h0;
  const Real last2 = d1 * d1 + h1 * h1;
  RangeRun<Real> ranges{min(first2, last2), max(first2, last2)};
  const Real dd = d1 - d0;
  const Real dh = h1 - h0;
  const Real along = -(d0 * dd + h0 * dh);
  if (!any(where & (along > 0.0))) return ranges;
  const Real length2 = dd * dd + dh * dh;
  const Real cross = d0 * dh - h0 * dd;
  const Mask<Real> foot = (along > 0.0) & (along < length2);
  ranges.least2 = select(foot, min(ranges.least2, cross * cross / length2), ranges.least2);
  return ranges;
}

/// Marks the bins from slant range low_m to high_m.
OBLIQ_INLINE void mark_bins(const RangeAxis& axis, double low_m, double high_m, std::uint8_t* marks) {
  if (!(high_m >= axis.r_min_m && low_m < axis.r_max_m)) return;
  const int last = high_m >= axis.r_max_m ? axis.n_range - 1 : axis.range_bin(high_m);
  for (int bin = low_m < axis.r_min_m ? 0 : axis.range_bin(low_m); bin <= last; ++bin) marks[bin] = 1;
}

/// The range whose 1 / r^2 is the mean, by solid angle, over a straight segment of a profile between two
/// ranges: the power of constant gamma is K gamma dOmega / r^2. Over level ground 1 / r is linear in the sine
/// of the elevation, and the mean of its square is exactly this.
template <typename Real>
OBLIQ_INLINE Real mean_power_range_m(Real r0_m, Real r1_m) {
  const Real r01 = r0_m * r1_m;
  return clamp(r01 * sqrt(3.0 / (r0_m * r0_m + r01 + r1_m * r1_m)), min(r0_m, r1_m), max(r0_m, r1_m));
}

/// A part of a segment, as a sample has it. share: of a strip one radian wide, its solid angle. turn_sin and
/// turn_cos: of the angle that it fills as seen from the antenna, times both ends' ranges; lit where the
/// first is positive.
template <typename Real>
struct SegmentPart {
  Real range_m, share, height_m, distance_m;
  Real turn_sin, turn_cos;
};

/// The part from (d0, h0) at range r0 to (d1, h1) at range r1. `cross`: of the two ends; that of two points
/// of the segment times the step between, so that a tiny part loses no digits.
template <typename Real>
OBLIQ_INLINE SegmentPart<Real> part_of(Real cross, Real d0, Real h0, Real r0, Real d1, Real h1, Real r1) {
  // sin e1 - sin e0 = sin(e1 - e0) (cos e0 + cos e1) / (1 + cos(e1 - e0)).
  const Real dot = d0 * d1 + h0 * h1;
  const Real r01 = r0 * r1;
  return {mean_power_range_m(r0, r1),
          cross * (d0 * r1 + d1 * r0) / (r01 * (r01 + dot)),
          (h0 + h1) / 2.0,
          (d0 + d1) / 2.0,
          cross,
          dot};
}

/// Where a segment A + t D, not before `from` nor beyond `to`, is at range `edge`: |A + t D|^2 = edge^2, or
/// t = (-A.D +- sqrt(D.D edge^2 - (A x D)^2)) / D.D, by Lagrange's identity without the cancellation of the
/// usual discriminant. rate2: D.D, along: A.D, cross: A x D. sign: 1 where range grows with t, else -1.
template <typename Real>
OBLIQ_INLINE Real edge_at(Real rate2, Real along, Real cross, Real sign, Real edge, Real from, Real to) {
  const Real root = sqrt(max(Real{}, rate2 * edge * edge - cross * cross));
  return clamp((sign * root - along) / rate2, from, to);
}

}  // namespace obliq
