#pragma once
// How a vertical profile through the antenna crosses the ground's cells and their triangles. Exact up to
// double rounding: every crossing is worked out from the antenna, nothing accumulates.
#include "server/radar/simd/ground/grid_view.h"
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

/// What stays the same all along a profile.
template <typename Real>
struct ProfileRates {
  Real sin, cos;
  Real per_x, per_z;        ///< ground distance a metre of x or z; infinite along the other axis
  Real rate_u, rate_v;      ///< cells a metre of ground distance
  Real rate;                ///< of u + v
  Real ahead_i, ahead_j;    ///< from a cell's number to that of the grid line by which it is left
  double start_u, start_v;  ///< the antenna, in cells from node (0, 0)
};

template <typename Real>
OBLIQ_INLINE ProfileRates<Real> profile_rates(const GroundView& ground, Real sin, Real cos) {
  const GridView& grid = ground.grid;
  const Real infinite = broadcast<Real>(__builtin_inf());
  ProfileRates<Real> p;
  p.sin = sin;
  p.cos = cos;
  p.per_x = select(sin != 0.0, 1.0 / sin, infinite);
  p.per_z = select(cos != 0.0, 1.0 / cos, infinite);
  p.rate_u = sin / grid.cell_m;
  p.rate_v = cos / grid.cell_m;
  p.rate = p.rate_u + p.rate_v;
  p.ahead_i = select(sin > 0.0, broadcast<Real>(1), Real{});
  p.ahead_j = select(cos > 0.0, broadcast<Real>(1), Real{});
  p.start_u = (ground.antenna_x_m - grid.x0_m) / grid.cell_m;
  p.start_v = (ground.antenna_z_m - grid.z0_m) / grid.cell_m;
  return p;
}

/// The cell that a profile stands in, whole numbers, and how far it has come.
template <typename Real>
struct Cells {
  Real d, i, j;

  OBLIQ_INLINE Mask<Real> on(const GridView& grid) const {
    return (i >= 0.0) & (j >= 0.0) & (i < static_cast<double>(grid.nx - 1)) &
           (j < static_cast<double>(grid.nz - 1));
  }
};

/// Ground distances at which a profile meets the two grid lines ahead, and the nearer one.
template <typename Real>
struct CellEnds {
  Real to_x, to_z, nearest;
};

template <typename Real>
OBLIQ_INLINE CellEnds<Real> cell_ends(const GroundView& ground, const ProfileRates<Real>& p,
                                      const Cells<Real>& cells) {
  const GridView& grid = ground.grid;
  const Real infinite = broadcast<Real>(__builtin_inf());
  CellEnds<Real> ends;
  const Real x = grid.x0_m + (cells.i + p.ahead_i) * grid.cell_m;
  const Real z = grid.z0_m + (cells.j + p.ahead_j) * grid.cell_m;
  ends.to_x = select(p.sin != 0.0, (x - ground.antenna_x_m) * p.per_x, infinite);
  ends.to_z = select(p.cos != 0.0, (z - ground.antenna_z_m) * p.per_z, infinite);
  ends.nearest = min(ends.to_x, ends.to_z);
  return ends;
}

/// Moves profiles to `end`; those that leave their cells, to the next ones.
template <typename Real>
OBLIQ_INLINE void move_on(const ProfileRates<Real>& p, const CellEnds<Real>& ends, Mask<Real> active,
                          Mask<Real> leaves, Real end, Cells<Real>& cells) {
  const Mask<Real> by_x = ends.to_x < ends.to_z;
  cells.i = select(leaves & by_x, cells.i + (2.0 * p.ahead_i - 1.0), cells.i);
  cells.j = select(leaves & inverse(by_x), cells.j + (2.0 * p.ahead_j - 1.0), cells.j);
  cells.d = select(active, end, cells.d);
}

/// Heights at the corners of a cell, of nodes (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1).
template <typename Real>
struct Corners {
  Real y00, y10, y01, y11;
  Mask<Real> known;  ///< all four
};

/// The place in GridView::y_m of a cell's first node; of cell (0, 0) where that is not wanted.
template <typename Real>
OBLIQ_INLINE Real number_of(const GridView& grid, const Cells<Real>& cells, Mask<Real> wanted) {
  return select(wanted, cells.j * static_cast<double>(grid.nx) + cells.i, Real{});
}
template <typename Real>
OBLIQ_INLINE Corners<Real> corners(const GridView& grid, Real number) {
  const auto at = to_u64(number);
  const auto [y00, y10] = gather_pairs(grid.y_m, at);
  const auto [y01, y11] = gather_pairs(grid.y_m, at + static_cast<std::uint64_t>(grid.nx));
  const Real all_four = (y00 + y10) + (y01 + y11);
  return {y00, y10, y01, y11, all_four == all_four};
}

/// A triangle of a cell as a profile cuts it: height = start + rise d.
template <typename Real>
struct TriangleCut {
  Mask<Real> upper;   ///< that of node (i + 1, j + 1), else of node (i, j)
  Real per_i, per_j;  ///< height a cell
  Real start, rise;
};

template <typename Real>
OBLIQ_INLINE TriangleCut<Real> triangle_cut(const ProfileRates<Real>& p, const Cells<Real>& cells,
                                            const Corners<Real>& y, Mask<Real> upper) {
  // Position in the cell at d = 0.
  const Real s = p.start_u - cells.i;
  const Real t = p.start_v - cells.j;
  TriangleCut<Real> cut;
  cut.upper = upper;
  cut.per_i = select(upper, y.y11 - y.y01, y.y10 - y.y00);
  cut.per_j = select(upper, y.y11 - y.y10, y.y01 - y.y00);
  cut.start = select(upper, y.y11 + cut.per_i * (s - 1.0) + cut.per_j * (t - 1.0),
                     y.y00 + cut.per_i * s + cut.per_j * t);
  cut.rise = cut.per_i * p.rate_u + cut.per_j * p.rate_v;
  return cut;
}

/// Calls triangle(where, cut, d0, d1) for what a profile crosses of its cell between `cells.d` and `end`: one
/// triangle, and another one where it crosses the diagonal. d1 > d0 in `where`.
template <typename Real, typename Triangle>
OBLIQ_INLINE void visit_triangles(const ProfileRates<Real>& p, const Cells<Real>& cells,
                                  const Corners<Real>& y, Mask<Real> known, Real end,
                                  const Triangle& triangle) {
  // Position in the cell at d = 0; its triangles meet where the two add up to 1.
  const Real s = p.start_u - cells.i;
  const Real t = p.start_v - cells.j;
  const Real sum0 = s + t + cells.d * p.rate;
  const Real sum1 = s + t + end * p.rate;
  const Mask<Real> both = (sum0 < 1.0) != (sum1 < 1.0);
  const Real diagonal = clamp((1.0 - s - t) / p.rate, cells.d, end);
  const auto visit = [&](Mask<Real> where, Mask<Real> upper, Real d0, Real d1)
      __attribute__((always_inline)) {
    triangle(where & (d1 > d0), triangle_cut(p, cells, y, upper), d0, d1);
  };
  visit(known, select(both, sum0, sum0 + sum1) > select(both, sum1, broadcast<Real>(2)), cells.d,
        select(both, diagonal, end));
  if (const Mask<Real> two = known & both; any(two)) visit(two, sum0 < sum1, diagonal, end);
}

/// Walks profiles outwards, cell by cell, up to `end_m` or the grid's border, until none goes on. For each
/// cell calls
///   next(active, ends, to)                the profiles that march it, of the active ones; it may cut the
///   cell by a
///                                         `to` before end_m;
///   cell(active, known, number, end)      `known` has a meaning in active lanes only;
///   triangle(where, cut, d0, d1)          as visit_triangles does, where the cell is known.
template <typename Real, typename Next, typename Cell, typename Triangle>
OBLIQ_INLINE void march(const GroundView& ground, const ProfileRates<Real>& p, const Real& end_m,
                        Cells<Real>& cells, const Next& next, const Cell& cell, const Triangle& triangle) {
  while (true) {
    const CellEnds<Real> ends = cell_ends(ground, p, cells);
    Real to = end_m;
    const Mask<Real> active = next((cells.d < end_m) & cells.on(ground.grid), ends, to);
    if (!any(active)) return;
    const Real end = max(cells.d, min(ends.nearest, to));
    const Real number = number_of(ground.grid, cells, active);
    const Corners<Real> y = corners(ground.grid, number);
    cell(active, y.known, number, end);
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, active, active & (ends.nearest <= to), end, cells);
  }
}

}  // namespace obliq
