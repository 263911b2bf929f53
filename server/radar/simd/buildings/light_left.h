#pragma once
#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// What buildings leave of the light of a plane's ground, by range bin. Light goes by the sines of
/// elevations, where there are some, else by their tangents.
struct LightLeft {
  /// Behind the last that is used there is room for a register.
  static constexpr int kSpare = 32;
  double* visible;  ///< [n_range + 1 + kSpare] scratch: up to a bin's near edge, over terrain
  double* hidden;   ///< scratch: what buildings hide of it
  float* left;      ///< [n_range + kSpare] share that is left: 0 where less than a gap is
  int from, to;     ///< the bins whose share is written, at most n_range
};

/// Finds it from what NodeProfiles::hidden has.
OBLIQ_KERNEL(void, light_left, const NodeProfiles&, int plane, int n_range, LightLeft&);

}  // namespace obliq
