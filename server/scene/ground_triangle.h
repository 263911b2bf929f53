#pragma once
#include "server/scene/tolerances.h"
#include "terrain/base/select.h"

namespace obliq {

/// One of the two triangles of a grid cell, as the plane y = y0 + slope_x (x - x0) + slope_z (z - z0). Real:
/// double, or eight of them (server/radar/simd/lanes/lanes.h says why all is inlined).
template <typename Real>
struct GroundTriangle {
  using Mask = decltype(Real{} < Real{});
  Mask upper;
  Real west, south, cell_m;
  Real x0, z0, y0, slope_x, slope_z;

  /// Of cell (i, j), whole numbers, with the heights of its corners. Grid: HeightGrid or GridView.
  template <typename Grid>
  [[gnu::always_inline]] GroundTriangle(const Grid& grid, Real i, Real j, Mask is_upper, Real y00, Real y10,
                                        Real y01, Real y11)
      : upper(is_upper),
        west(grid.x0_m + i * grid.cell_m),
        south(grid.z0_m + j * grid.cell_m),
        cell_m(Real{} + grid.cell_m),
        x0(select(upper, grid.x0_m + (i + 1.0) * grid.cell_m, west)),
        z0(select(upper, grid.z0_m + (j + 1.0) * grid.cell_m, south)),
        y0(select(upper, y11, y00)),
        slope_x((select(upper, y11, y10) - select(upper, y01, y00)) / grid.cell_m),
        slope_z((select(upper, y11, y01) - select(upper, y10, y00)) / grid.cell_m) {}

  /// Rate at which a ray's height above the plane changes along its unit direction; negative from above.
  [[gnu::always_inline]] Real descent(Real dx, Real dy, Real dz) const {
    return dy - slope_x * dx - slope_z * dz;
  }
  template <typename Place>
  [[gnu::always_inline]] Real height_above(Place x, Place y, Place z) const {
    return y - y0 - slope_x * (x - x0) - slope_z * (z - z0);
  }
  /// Of the triangle, but for the slack.
  [[gnu::always_inline]] Mask holds(Real x, Real z) const {
    const Real s = (x - west) / cell_m;
    const Real t = (z - south) / cell_m;
    const Real slack = kGroundEdge_m / cell_m;
    const Mask in_upper = (s <= 1.0 + slack) & (t <= 1.0 + slack) & (s + t >= 1.0 - slack);
    const Mask in_lower = (s >= -slack) & (t >= -slack) & (s + t <= 1.0 + slack);
    return select(upper, in_upper, in_lower);
  }
  /// Square of the length of the plane's normal (-slope_x, 1, -slope_z).
  [[gnu::always_inline]] Real steepness2() const { return 1.0 + slope_x * slope_x + slope_z * slope_z; }
};

}  // namespace obliq
