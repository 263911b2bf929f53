#pragma once
// The owner rule. Where bins are added up as voltages, a scatterer that a bin's edge cuts must not answer
// with one phase in both bins: the sum would be too bright, by up to 0.9 dB, the more the finer the sampling.
// It belongs to the bin that holds its reference point. Its part in another bin is a scatterer of its own, of
// the same place: ground, whose cells are many. A face may be the only one in its bins: its part in a bin
// next to its own is a quarter turn off, and the sum of both has the power of both, whatever the shares:
// |sqrt(P1) + i sqrt(P2)|^2 = P1 + P2. Forwards or back is drawn, so that of more than two parts it is the
// mean.
#include "server/radar/simd/echoes/range_axis.h"
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

/// The bins that scatterers may belong to.
struct OwnerBins {
  RangeAxis axis;
  double per_rad = 0;          ///< azimuth bins a radian
  bool ground = false;         ///< parts of ground cells in other bins are scatterers of their own
  bool quarter_turns = false;  ///< parts of faces in neighbouring bins are a quarter turn off, else as ground
};

/// Left edges of a wedge's azimuth bins: sines and cosines of their bearings.
struct WedgeEdges {
  double sin[8] = {};
  double cos[8] = {};
};

/// By how many bins the one that a scatterer's power lies in is off its own.
template <typename Real>
struct OwnerOffset {
  Real along, across;  ///< whole numbers of range and azimuth bins

  /// Bits 32 to 47 of its kind, 0 for its own bin. Numbers of bins repeat after 256: no scatterer is so long.
  OBLIQ_INLINE auto code() const { return ((to_i64(along) & 0xff) | (to_i64(across) & 0xff) << 8) << 32; }
  OBLIQ_INLINE Mask<Real> is_far() const { return max(along * along, across * across) > 1.0; }
  /// By how many turns a face's part is off, by its hash; not of a far one.
  template <typename Word>
  OBLIQ_INLINE Real turns(Word hash) const {
    const Real by_range = along * along;
    const Real by_azimuth = across * across;
    return 0.25 * max(by_range, by_azimuth) * (1.0 - 2.0 * by_range * to_doubles(hash & 1)) *
           (1.0 - 2.0 * by_azimuth * to_doubles((hash >> 1) & 1));
  }
};

/// (dx, dz), range: of the reference point from the antenna; (sin, cos): of the left edge of the azimuth bin
/// that the power lies in.
template <typename Real>
OBLIQ_INLINE OwnerOffset<Real> owner_offset(const OwnerBins& bins, Real dx, Real dz, Real range,
                                            Real range_bin, Real sin, Real cos) {
  const Real far = broadcast<Real>(100);
  const Real right = dx * cos - dz * sin;
  const Real ahead = dx * sin + dz * cos;
  const Mask<Real> before = ahead > 1e-9;
  // Within a few bins of the edge atan(t) is t - t^3 / 3.
  const Real tangent =
      clamp(right / select(before, ahead, broadcast<Real>(1)), broadcast<Real>(-1), broadcast<Real>(1));
  const Real angle = tangent * (1.0 - tangent * tangent * (1.0 / 3));
  const double bins_per_m = 1 / bins.axis.range_spacing_m;
  return {range_bin - floor(clamp((range - bins.axis.r_min_m) * bins_per_m, broadcast<Real>(-100),
                                  broadcast<Real>(1e6))),
          select(before, floor(clamp(angle * bins.per_rad, broadcast<Real>(-100), far)), far)};
}

/// Where in its cell a scatterer's reference point lies, in cells: on a lattice of middles the phases of all
/// would agree again after some metres of flight. From the hash of its place.
template <typename Real, typename Word>
OBLIQ_INLINE Real jitter(Word hash, int shift) {
  return (to_doubles((hash >> shift) & 0xffff) + 0.5) * 0x1p-16;
}

}  // namespace obliq
