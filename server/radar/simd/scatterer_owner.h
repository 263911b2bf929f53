#pragma once
// The owner rule. Where bins are added up as voltages, a scatterer that a bin's edge cuts must not answer
// with one phase in both bins: the sum would be too bright, by up to 0.9 dB, the more the finer the sampling.
// It belongs to the bin that holds its reference point; its part in another bin is a scatterer of its own, of
// the same place.
#include "server/radar/simd/lanes.h"
#include "server/radar/simd/range_axis.h"

namespace obliq {

/// The bins that scatterers may belong to.
struct OwnerBins {
  RangeAxis axis;
  double per_rad = 0;  ///< azimuth bins a radian; 0: every bin has all of a scatterer
};

/// Left edges of a wedge's azimuth bins: sines and cosines of their bearings.
struct WedgeEdges {
  double sin[8] = {};
  double cos[8] = {};
};

/// By how many bins the one that a scatterer's power lies in is off its own, in range and azimuth: bits 32 to
/// 47 of its kind, 0 for its own. (dx, dz), range: of the reference point from the antenna; (sin, cos): of
/// the left edge of the azimuth bin that the power lies in. Numbers of bins repeat after 256: no scatterer is
/// so long.
template <typename Real>
OBLIQ_INLINE auto owner_code(const OwnerBins& bins, Real dx, Real dz, Real range, Real range_bin, Real sin,
                             Real cos) {
  const Real far = broadcast<Real>(100);
  const Real right = dx * cos - dz * sin;
  const Real ahead = dx * sin + dz * cos;
  const Mask<Real> before = ahead > 1e-9;
  // Within a few bins of the edge atan(t) is t - t^3 / 3.
  const Real tangent =
      clamp(right / select(before, ahead, broadcast<Real>(1)), broadcast<Real>(-1), broadcast<Real>(1));
  const Real angle = tangent * (1.0 - tangent * tangent / 3.0);
  const Real across = select(before, floor(clamp(angle * bins.per_rad, broadcast<Real>(-100), far)), far);
  const Real along = range_bin - floor(clamp((range - bins.axis.r_min_m) / bins.axis.range_spacing_m,
                                             broadcast<Real>(-100), broadcast<Real>(1e6)));
  return ((to_i64(along) & 0xff) | (to_i64(across) & 0xff) << 8) << 32;
}

/// Where in its cell a scatterer's reference point lies, in cells: on a lattice of middles the phases of all
/// would agree again after some metres of flight. From the hash of its place.
template <typename Real, typename Word>
OBLIQ_INLINE Real jitter(Word hash, int shift) {
  return (to_doubles((hash >> shift) & 0xffff) + 0.5) * 0x1p-16;
}

}  // namespace obliq
