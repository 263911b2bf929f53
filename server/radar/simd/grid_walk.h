#pragma once
// Eight vertical planes that walk the grid side by side, cell by cell, outwards: what the marches over ground
// have in common. To the bit as GroundWalk.
#include "server/radar/simd/cell_prefetch.h"
#include "server/radar/simd/lanes.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq::OBLIQ_ISA {

/// Directions of the planes: what stays the same all along.
struct PlaneRates {
  Lanes sin, cos;
  Lanes per_x, per_z;       ///< ground distance a metre of x or z; infinite along the other axis
  Lanes rate_u, rate_v;     ///< cells a metre of ground distance
  Lanes rate;               ///< of u + v
  Lanes ahead_i, ahead_j;   ///< from a cell's number to that of the grid line by which it is left
  double start_u, start_v;  ///< the antenna, in cells from node (0, 0)
};

OBLIQ_LANES PlaneRates plane_rates(const GroundScene& scene, const WalkingPlanes& planes) {
  const LaneGrid& grid = scene.grid;
  const Lanes infinite = all_lanes(__builtin_inf());
  PlaneRates p;
  p.sin = load_lanes(planes.sin_bearing);
  p.cos = load_lanes(planes.cos_bearing);
  p.per_x = select(p.sin != 0.0, 1.0 / p.sin, infinite);
  p.per_z = select(p.cos != 0.0, 1.0 / p.cos, infinite);
  p.rate_u = p.sin / grid.cell_m;
  p.rate_v = p.cos / grid.cell_m;
  p.rate = p.rate_u + p.rate_v;
  p.ahead_i = select(p.sin > 0.0, all_lanes(1), Lanes{});
  p.ahead_j = select(p.cos > 0.0, all_lanes(1), Lanes{});
  p.start_u = (scene.antenna_x_m - grid.x0_m) / grid.cell_m;
  p.start_v = (scene.antenna_z_m - grid.z0_m) / grid.cell_m;
  return p;
}

/// The cells that planes stand in, and how far they have come.
struct Cells {
  Lanes d, i, j;

  OBLIQ_LANES LaneFlags on(const LaneGrid& grid) const {
    return (i >= 0.0) & (j >= 0.0) & (i < static_cast<double>(grid.nx - 1)) &
           (j < static_cast<double>(grid.nz - 1));
  }
  OBLIQ_LANES Lanes number(const LaneGrid& grid, LaneFlags active) const {
    return select(active, j * static_cast<double>(grid.nx) + i, Lanes{});
  }
};

OBLIQ_LANES Cells cells_of(const WalkingPlanes& planes) {
  return {load_lanes(planes.d_m), load_lanes(planes.i), load_lanes(planes.j)};
}
OBLIQ_LANES void store_cells(WalkingPlanes& planes, const Cells& cells) {
  store_lanes(planes.d_m, cells.d);
  store_lanes(planes.i, cells.i);
  store_lanes(planes.j, cells.j);
}

/// Asks for the heights that planes come to 32 cells later: memory has answered by then.
OBLIQ_LANES void prefetch_ahead(const LaneGrid& grid, const PlaneRates& p, const Cells& cells) {
  const Lanes ahead = cells.d + 32 * grid.cell_m;
  prefetch_cells(grid, p.start_u + ahead * p.rate_u, p.start_v + ahead * p.rate_v);
}

/// Ground distances at which planes meet the two grid lines ahead, and the nearer one.
struct CellEnds {
  Lanes to_x, to_z, nearest;
};

OBLIQ_LANES CellEnds cell_ends(const GroundScene& scene, const PlaneRates& p, const Cells& cells) {
  const LaneGrid& grid = scene.grid;
  const Lanes infinite = all_lanes(__builtin_inf());
  CellEnds ends;
  ends.to_x =
      select(p.sin != 0.0, (grid.x0_m + (cells.i + p.ahead_i) * grid.cell_m - scene.antenna_x_m) * p.per_x,
             infinite);
  ends.to_z =
      select(p.cos != 0.0, (grid.z0_m + (cells.j + p.ahead_j) * grid.cell_m - scene.antenna_z_m) * p.per_z,
             infinite);
  ends.nearest = least(ends.to_x, ends.to_z);
  return ends;
}

/// Moves planes to `end`; those that leave their cells, to the next ones.
OBLIQ_LANES void move_on(const PlaneRates& p, const CellEnds& ends, LaneFlags active, LaneFlags leaves,
                         Lanes end, Cells& cells) {
  const LaneFlags by_x = ends.to_x < ends.to_z;
  cells.i = select(leaves & by_x, cells.i + (2.0 * p.ahead_i - 1.0), cells.i);
  cells.j = select(leaves & ~by_x, cells.j + (2.0 * p.ahead_j - 1.0), cells.j);
  cells.d = select(active, end, cells.d);
}

/// Heights at the corners of cells; `known` where there are all four.
struct Corners {
  Lanes y00, y10, y01, y11;
  LaneFlags known;
};

OBLIQ_LANES Corners corners(const LaneGrid& grid, LaneBits at) {
  const LaneBits above = at + static_cast<std::uint64_t>(grid.nx);
  Corners y;
  const auto [y00, y10] = gather_pairs(grid.y_m, at);
  const auto [y01, y11] = gather_pairs(grid.y_m, above);
  y.y00 = y00;
  y.y10 = y10;
  y.y01 = y01;
  y.y11 = y11;
  const Lanes all_four = (y.y00 + y.y10) + (y.y01 + y.y11);
  y.known = all_four == all_four;
  return y;
}

/// A triangle of a cell as planes cut it: height = start + rise d.
struct TriangleCut {
  LaneFlags upper;
  Lanes per_i, per_j;  ///< height a cell
  Lanes start, rise;
};

/// Calls triangle(where, cut, d0, d1) for what planes cross of their cells between `cells.d` and `end`: one
/// triangle, and another one in those that cross the diagonal. d1 > d0 in `where`.
template <class Triangle>
OBLIQ_LANES void visit_triangles(const PlaneRates& p, const Cells& cells, const Corners& y, LaneFlags known,
                                 Lanes end, const Triangle& triangle) {
  // Position in the cell at d = 0; its triangles meet where the two add up to 1.
  const Lanes s = p.start_u - cells.i;
  const Lanes t = p.start_v - cells.j;
  const Lanes sum0 = s + t + cells.d * p.rate;
  const Lanes sum1 = s + t + end * p.rate;
  const LaneFlags both = (sum0 < 1.0) != (sum1 < 1.0);
  const Lanes diagonal = clamp((1.0 - s - t) / p.rate, cells.d, end);
  const auto visit = [&](LaneFlags where, LaneFlags upper, Lanes d0, Lanes d1)
      __attribute__((always_inline)) {
    TriangleCut cut;
    cut.upper = upper;
    cut.per_i = select(upper, y.y11 - y.y01, y.y10 - y.y00);
    cut.per_j = select(upper, y.y11 - y.y10, y.y01 - y.y00);
    cut.start = select(upper, y.y11 + cut.per_i * (s - 1.0) + cut.per_j * (t - 1.0),
                       y.y00 + cut.per_i * s + cut.per_j * t);
    cut.rise = cut.per_i * p.rate_u + cut.per_j * p.rate_v;
    triangle(where & (d1 > d0), cut, d0, d1);
  };
  visit(known, select(both, sum0, sum0 + sum1) > select(both, sum1, all_lanes(2)), cells.d,
        select(both, diagonal, end));
  if (const LaneFlags two = known & both; any(two)) visit(two, sum0 < sum1, diagonal, end);
}

}  // namespace obliq::OBLIQ_ISA
