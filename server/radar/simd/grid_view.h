#pragma once

namespace obliq {

/// A HeightGrid as the inner loops see it.
struct LaneGrid {
  const float* y_m;  ///< [nz][nx]
  int nx, nz;
  double x0_m, z0_m, cell_m;
};

}  // namespace obliq
