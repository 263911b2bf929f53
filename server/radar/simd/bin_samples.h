#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"
#include "server/radar/simd/range_axis.h"

namespace obliq {

/// floor(log2 r), from 0 to 63: by the exponent's bits.
template <typename Real>
OBLIQ_INLINE Real octave_of(Real r) {
  return clamp(to_doubles((as_bits(r) >> 52) & 0x7ff) - 1023.0, Real{}, broadcast<Real>(63));
}

/// The swath's range bins and its ground cells by octave of range (SpeckleField).
struct SwathCells {
  RangeAxis axis;
  double cells_per_m[64];
  double level[64];
};

/// What the samples' powers have in common.
struct EchoFactors {
  bool range_normalisation;
  double gamma[256];  ///< by material; NaN: not a constant
};

/// A SampleBatch's arrays, read up to a multiple of 8.
struct SampleView {
  int n;
  const double* slant_range_m;
  const double* x_m;
  const double* z_m;
  const double* solid_angle_sr;
  const std::uint8_t* material;
};

/// Where samples fall, and what they scatter.
struct BinnedSamples {
  static constexpr int kMost = 1024;
  static constexpr std::int32_t kOutside = -1;
  std::int32_t range_bin[kMost];  ///< kOutside: not in the swath
  double range2_m2[kMost];
  double sigma_m2[kMost];     ///< NaN where gamma is no constant
  double spreading[kMost];    ///< r^4, or 1 with range normalisation
  std::uint64_t cell[kMost];  ///< ScattererKey::place and the level in its kind, as if all were ground
  std::uint64_t level[kMost];
};

OBLIQ_KERNEL(void, bin_samples, const SwathCells&, const EchoFactors&, const SampleView&, BinnedSamples&);

}  // namespace obliq
