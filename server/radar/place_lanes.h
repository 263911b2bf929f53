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

/// Where samples fall.
struct PlacedSamples {
  static constexpr int kMost = 1024;
  static constexpr std::int32_t kOutside = -1;
  std::int32_t range_bin[kMost];  ///< kOutside: not in the swath
  double range2_m2[kMost];
  std::uint64_t cell[kMost];  ///< ScattererKey::place and the level in its kind, as if all were ground
  std::uint64_t level[kMost];
};

/// What n samples at ranges and world positions are. The arrays are read up to a multiple of 8.
using PlaceKernel = void (*)(const SwathCells&, int n, const double* slant_range_m, const double* x_m,
                             const double* z_m, PlacedSamples&);

}  // namespace obliq
