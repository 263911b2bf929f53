#pragma once
// Eight vertical planes that walk the grid side by side, cell by cell, outwards: what the marches over ground
// have in common. To the bit as GroundWalk.
#include "server/radar/simd/cell_prefetch.h"
#include "server/radar/simd/lanes.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq::OBLIQ_ISA {

/// Directions of the planes: what stays the same all along.
struct PlaneRates {
  f64x8 sin, cos;
  f64x8 per_x, per_z;       ///< ground distance a metre of x or z; infinite along the other axis
  f64x8 rate_u, rate_v;     ///< cells a metre of ground distance
  f64x8 rate;               ///< of u + v
  f64x8 ahead_i, ahead_j;   ///< from a cell's number to that of the grid line by which it is left
  double start_u, start_v;  ///< the antenna, in cells from node (0, 0)
};

OBLIQ_INLINE PlaneRates plane_rates(const GroundScene& scene, const WalkingPlanes& planes) {
  const LaneGrid& grid = scene.grid;
  const f64x8 infinite = broadcast(__builtin_inf());
  PlaneRates p;
  p.sin = load(planes.sin_bearing);
  p.cos = load(planes.cos_bearing);
  p.per_x = select(p.sin != 0.0, 1.0 / p.sin, infinite);
  p.per_z = select(p.cos != 0.0, 1.0 / p.cos, infinite);
  p.rate_u = p.sin / grid.cell_m;
  p.rate_v = p.cos / grid.cell_m;
  p.rate = p.rate_u + p.rate_v;
  p.ahead_i = select(p.sin > 0.0, broadcast(1), f64x8{});
  p.ahead_j = select(p.cos > 0.0, broadcast(1), f64x8{});
  p.start_u = (scene.antenna_x_m - grid.x0_m) / grid.cell_m;
  p.start_v = (scene.antenna_z_m - grid.z0_m) / grid.cell_m;
  return p;
}

/// The cells that planes stand in, and how far they have come.
struct Cells {
  f64x8 d, i, j;

  OBLIQ_INLINE mask8 on(const LaneGrid& grid) const {
    return (i >= 0.0) & (j >= 0.0) & (i < static_cast<double>(grid.nx - 1)) &
           (j < static_cast<double>(grid.nz - 1));
  }
  OBLIQ_INLINE f64x8 number(const LaneGrid& grid, mask8 active) const {
    return select(active, j * static_cast<double>(grid.nx) + i, f64x8{});
  }
};

OBLIQ_INLINE Cells cells_of(const WalkingPlanes& planes) {
  return {load(planes.d_m), load(planes.i), load(planes.j)};
}
OBLIQ_INLINE void store_cells(WalkingPlanes& planes, const Cells& cells) {
  store(planes.d_m, cells.d);
  store(planes.i, cells.i);
  store(planes.j, cells.j);
}

/// Asks for the heights that planes come to 32 cells later: memory has answered by then.
OBLIQ_INLINE void prefetch_ahead(const LaneGrid& grid, const PlaneRates& p, const Cells& cells) {
  const f64x8 ahead = cells.d + 32 * grid.cell_m;
  prefetch_cells(grid, p.start_u + ahead * p.rate_u, p.start_v + ahead * p.rate_v);
}

/// Ground distances at which planes meet the two grid lines ahead, and the nearer one.
struct CellEnds {
  f64x8 to_x, to_z, nearest;
};

OBLIQ_INLINE CellEnds cell_ends(const GroundScene& scene, const PlaneRates& p, const Cells& cells) {
  const LaneGrid& grid = scene.grid;
  const f64x8 infinite = broadcast(__builtin_inf());
  CellEnds ends;
  ends.to_x =
      select(p.sin != 0.0, (grid.x0_m + (cells.i + p.ahead_i) * grid.cell_m - scene.antenna_x_m) * p.per_x,
             infinite);
  ends.to_z =
      select(p.cos != 0.0, (grid.z0_m + (cells.j + p.ahead_j) * grid.cell_m - scene.antenna_z_m) * p.per_z,
             infinite);
  ends.nearest = min(ends.to_x, ends.to_z);
  return ends;
}

/// Moves planes to `end`; those that leave their cells, to the next ones.
OBLIQ_INLINE void move_on(const PlaneRates& p, const CellEnds& ends, mask8 active, mask8 leaves, f64x8 end,
                          Cells& cells) {
  const mask8 by_x = ends.to_x < ends.to_z;
  cells.i = select(leaves & by_x, cells.i + (2.0 * p.ahead_i - 1.0), cells.i);
  cells.j = select(leaves & ~by_x, cells.j + (2.0 * p.ahead_j - 1.0), cells.j);
  cells.d = select(active, end, cells.d);
}

/// Heights at the corners of cells; `known` where there are all four.
struct Corners {
  f64x8 y00, y10, y01, y11;
  mask8 known;
};

OBLIQ_INLINE Corners corners(const LaneGrid& grid, u64x8 at) {
  const u64x8 above = at + static_cast<std::uint64_t>(grid.nx);
  Corners y;
  const auto [y00, y10] = gather_pairs(grid.y_m, at);
  const auto [y01, y11] = gather_pairs(grid.y_m, above);
  y.y00 = y00;
  y.y10 = y10;
  y.y01 = y01;
  y.y11 = y11;
  const f64x8 all_four = (y.y00 + y.y10) + (y.y01 + y.y11);
  y.known = all_four == all_four;
  return y;
}

/// A triangle of a cell as planes cut it: height = start + rise d.
struct TriangleCut {
  mask8 upper;
  f64x8 per_i, per_j;  ///< height a cell
  f64x8 start, rise;
};

/// Calls triangle(where, cut, d0, d1) for what planes cross of their cells between `cells.d` and `end`: one
/// triangle, and another one in those that cross the diagonal. d1 > d0 in `where`.
template <class Triangle>
OBLIQ_INLINE void visit_triangles(const PlaneRates& p, const Cells& cells, const Corners& y, mask8 known,
                                  f64x8 end, const Triangle& triangle) {
  // Position in the cell at d = 0; its triangles meet where the two add up to 1.
  const f64x8 s = p.start_u - cells.i;
  const f64x8 t = p.start_v - cells.j;
  const f64x8 sum0 = s + t + cells.d * p.rate;
  const f64x8 sum1 = s + t + end * p.rate;
  const mask8 both = (sum0 < 1.0) != (sum1 < 1.0);
  const f64x8 diagonal = clamp((1.0 - s - t) / p.rate, cells.d, end);
  const auto visit = [&](mask8 where, mask8 upper, f64x8 d0, f64x8 d1) __attribute__((always_inline)) {
    TriangleCut cut;
    cut.upper = upper;
    cut.per_i = select(upper, y.y11 - y.y01, y.y10 - y.y00);
    cut.per_j = select(upper, y.y11 - y.y10, y.y01 - y.y00);
    cut.start = select(upper, y.y11 + cut.per_i * (s - 1.0) + cut.per_j * (t - 1.0),
                       y.y00 + cut.per_i * s + cut.per_j * t);
    cut.rise = cut.per_i * p.rate_u + cut.per_j * p.rate_v;
    triangle(where & (d1 > d0), cut, d0, d1);
  };
  visit(known, select(both, sum0, sum0 + sum1) > select(both, sum1, broadcast(2)), cells.d,
        select(both, diagonal, end));
  if (const mask8 two = known & both; any(two)) visit(two, sum0 < sum1, diagonal, end);
}

}  // namespace obliq::OBLIQ_ISA
