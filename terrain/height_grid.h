#pragma once
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "terrain/base/select.h"

namespace obliq {

/// Origin and cell size are multiples of this, so that node coordinates are exact in float32 up to 2^19 m.
constexpr double kGridQuantum_m = 1.0 / 32;

/// Height at (s, t), each 0..1, of a cell with these heights at its nodes (i, j), (i + 1, j), (i, j + 1) and
/// (i + 1, j + 1). Of one place, or of eight (server/radar/simd/lanes/lanes.h says why it is always inlined).
template <typename Real>
[[gnu::always_inline]] inline Real height_on_triangles(Real y00, Real y10, Real y01, Real y11, Real s,
                                                       Real t) {
  const Real lower = y00 + s * (y10 - y00) + t * (y01 - y00);
  const Real upper = y11 + (1.0 - s) * (y01 - y11) + (1.0 - t) * (y10 - y11);
  return select(s + t <= 1.0, lower, upper);
}

/// The ground as every part of the program sees it: one height per node of a regular grid in world (x, z),
/// curvature and lift inside y. The surface is two triangles a cell, split along the diagonal from node
/// (i+1, j) to node (i, j+1), as Embree's GRID does it. Immutable once loaded.
struct HeightGrid {
  double x0_m = 0;         ///< world x of node (0, 0), a multiple of kGridQuantum_m
  double z0_m = 0;         ///< world z of node (0, 0), a multiple of kGridQuantum_m
  double cell_m = 1;       ///< node spacing in x and z, a multiple of kGridQuantum_m
  int nx = 0;              ///< nodes along x (east), at least 2
  int nz = 0;              ///< nodes along z (north), at least 2
  std::vector<float> y_m;  ///< y_m[nz][nx], world y; NaN where no ground is known

  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  double node_x_m(int i) const { return x0_m + i * cell_m; }
  double node_z_m(int j) const { return z0_m + j * cell_m; }
  double x1_m() const { return node_x_m(nx - 1); }
  double z1_m() const { return node_z_m(nz - 1); }
  double node_y_m(int i, int j) const { return static_cast<double>(y_m[index(i, j)]); }
  bool node_known(int i, int j) const { return !std::isnan(y_m[index(i, j)]); }

  /// A cell is ground when all four of its nodes are known. Cell (i, j) spans nodes i..i+1, j..j+1.
  bool cell_known(int i, int j) const {
    return i >= 0 && j >= 0 && i < nx - 1 && j < nz - 1 && node_known(i, j) && node_known(i + 1, j) &&
           node_known(i, j + 1) && node_known(i + 1, j + 1);
  }

  /// The surface's y at (x, z), on the triangle that holds it; NaN off the grid or over unknown ground.
  double height_at_m(double x_m, double z_m) const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const double u = (x_m - x0_m) / cell_m;
    const double v = (z_m - z0_m) / cell_m;
    if (!(u >= 0 && v >= 0 && u <= nx - 1 && v <= nz - 1)) return kNone;
    int i = static_cast<int>(u);
    int j = static_cast<int>(v);
    if (i > nx - 2) i = nx - 2;
    if (j > nz - 2) j = nz - 2;
    if (!cell_known(i, j)) return kNone;
    return height_on_triangles(node_y_m(i, j), node_y_m(i + 1, j), node_y_m(i, j + 1), node_y_m(i + 1, j + 1),
                               u - i, v - j);
  }
};

}  // namespace obliq
