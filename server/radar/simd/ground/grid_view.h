#pragma once
#include <glm/vec3.hpp>

#include "terrain/height_grid.h"

namespace obliq {

/// A HeightGrid as the inner loops see it.
struct GridView {
  const float* y_m;  ///< [nz][nx]
  int nx, nz;
  double x0_m, z0_m, cell_m;
};

/// The ground, and the antenna over it.
struct GroundView {
  GridView grid;
  double antenna_x_m, antenna_y_m, antenna_z_m;
};

inline GroundView ground_view(const HeightGrid& grid, const glm::dvec3& antenna_m) {
  return {{grid.y_m.data(), grid.nx, grid.nz, grid.x0_m, grid.z0_m, grid.cell_m},
          antenna_m.x,
          antenna_m.y,
          antenna_m.z};
}

}  // namespace obliq
