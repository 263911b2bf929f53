#pragma once
// From samples to bins, and to scatterers in bins.
#include <cstdint>

#include "server/radar/samples.h"
#include "server/radar/simd/echoes/range_axis.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// floor(log2 r), from 0 to 63: by the exponent's bits.
template <typename Real>
OBLIQ_INLINE Real octave_of(Real r) {
  return clamp(to_doubles((as_bits(r) >> 52) & 0x7ff) - 1023.0, Real{}, broadcast<Real>(63));
}

/// The swath's range bins and its ground cells by octave of range (SpeckleField).
struct SwathCells {
  RangeAxis axis;
  double cells_per_m[64];  ///< powers of 2
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

/// Samples by range bin, and the scatterers that they are added up to.
struct ScattererLists {
  static constexpr int kSpare = 8;              ///< elements that may be read behind the last one
  static constexpr std::uint32_t kLarge = 256;  ///< a bin with more samples is left to others
  const std::uint32_t* end;                     ///< of each bin among the samples
  const std::uint64_t* place;
  const std::uint64_t* kind;
  const double* power_w;
  std::uint32_t* bin;  ///< from here on of the scatterers
  std::uint64_t* sum_place;
  std::uint64_t* sum_kind;
  double* sum_power_w;
  std::uint32_t n;  ///< of them
};

/// Adds up bins from `first` on; returns the first that is not done, a large one or n_bins.
OBLIQ_KERNEL(std::uint32_t, sum_scatterers, ScattererLists&, std::uint32_t first, std::uint32_t n_bins);

}  // namespace obliq
