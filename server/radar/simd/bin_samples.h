#pragma once
#include <cstdint>

#include "server/radar/samples.h"
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

/// Where samples fall, and what they scatter. Samples are read up to a multiple of 8.
struct BinnedSamples {
  static constexpr std::int32_t kOutside = -1;
  std::int32_t range_bin[kBatch];  ///< kOutside: not in the swath
  double range2_m2[kBatch];
  double sigma_m2[kBatch];     ///< NaN where gamma is no constant
  double spreading[kBatch];    ///< r^4, or 1 with range normalisation
  std::uint64_t cell[kBatch];  ///< ScattererKey::place and the level in its kind, as if all were ground
  std::uint64_t level[kBatch];
};

OBLIQ_KERNEL(void, bin_samples, const SwathCells&, const EchoFactors&, const SampleBatch&, BinnedSamples&);

}  // namespace obliq
