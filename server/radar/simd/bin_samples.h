#pragma once
#include <cstdint>

namespace obliq {

/// The swath's range bins and its ground cells by octave of range (SpeckleField).
struct SwathCells {
  int n_range;
  double r_min_m, r_max_m, range_spacing_m;
  double cells_per_m[64];
  double level[64];
};

/// What the samples' powers have in common.
struct EchoFactors {
  bool range_normalisation;
  double gamma[256];  ///< by material; NaN: not a constant
};

/// A SampleBatch's arrays, read up to a multiple of 8.
struct PlaceInput {
  int n;
  const double* slant_range_m;
  const double* x_m;
  const double* z_m;
  const double* solid_angle_sr;
  const std::uint8_t* material;
};

/// Where samples fall, and what they scatter.
struct PlacedSamples {
  static constexpr int kMost = 1024;
  static constexpr std::int32_t kOutside = -1;
  std::int32_t range_bin[kMost];  ///< kOutside: not in the swath
  double range2_m2[kMost];
  double sigma_m2[kMost];     ///< NaN where gamma is no constant
  double spreading[kMost];    ///< r^4, or 1 with range normalisation
  std::uint64_t cell[kMost];  ///< ScattererKey::place and the level in its kind, as if all were ground
  std::uint64_t level[kMost];
};

using PlaceKernel = void (*)(const SwathCells&, const EchoFactors&, const PlaceInput&, PlacedSamples&);

}  // namespace obliq
