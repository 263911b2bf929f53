// GroundWalk and SweepPlane over bare ground for eight planes at a time, to the bit.
#include "server/radar/simd/visible_ground.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Moves lanes whose width ends where they stand on to the next one.
OBLIQ_INLINE void next_widths(unsigned mask, GroundLanes& lanes, f64x8 d, f64x8& width, f64x8& width_to) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((mask >> lane & 1) == 0) continue;
    double to = width_to[lane];
    while (to <= d[lane]) {
      lanes.width_rad[lane] = *lanes.next_width_rad[lane]++;
      to = *lanes.next_width_to_m[lane]++;
    }
    lanes.width_to_m[lane] = to;
  }
  width = load(lanes.width_rad);
  width_to = load(lanes.width_to_m);
}

}  // namespace

bool march_ground(const GroundScene& scene, GroundLanes& lanes, GroundPieces& pieces) {
  const LaneGrid& grid = scene.grid;
  const PlaneRates p = plane_rates(scene, lanes);
  const double cells_per_m = 1 / grid.cell_m;
  const f64x8 end_m = load(lanes.end_m);
  Cells cells = cells_of(lanes);
  f64x8 horizon_d = load(lanes.horizon_d_m);
  f64x8 horizon_h = load(lanes.horizon_h_m);
  f64x8 width = load(lanes.width_rad);
  f64x8 width_to = load(lanes.width_to_m);
  int n = pieces.n;
  bool left = false;
  while (true) {
    const mask8 active = (cells.d < end_m) & (cells.d <= scene.last_start_m) & cells.on(grid);
    if (!any(active)) break;
    if (n > GroundPieces::kMost - 2) {
      left = true;
      break;
    }
    if (const unsigned ended = movemask(active & (width_to <= cells.d)); ended != 0)
      next_widths(ended, lanes, cells.d, width, width_to);

    // The cell, up to its end or to where the width changes.
    const f64x8 to = min(width_to, end_m);
    const CellEnds ends = cell_ends(scene, p, cells);
    const f64x8 end = max(cells.d, min(ends.nearest, to));
    const f64x8 cell = cells.number(grid, active);
    const Corners y = corners(grid, to_u64(cell));
    prefetch_ahead(grid, p, cells);
    const auto triangle = [&](mask8 where, const TriangleCut& cut, f64x8 d0, f64x8 d1)
        __attribute__((always_inline)) {
      const f64x8 start = cut.start - scene.antenna_y_m;
      const f64x8 rise = cut.rise;
      const f64x8 h0 = start + rise * d0;
      const f64x8 h1 = start + rise * d1;
      // Facing when the antenna is above the triangle's plane: then elevation rises along it.
      const mask8 facing = where & (start < 0.0);
      const mask8 hides0 = h0 * horizon_d < horizon_h * d0;
      const mask8 rises = facing & ~(h1 * horizon_d < horizon_h * d1);
      const f64x8 out = clamp(start * horizon_d / (horizon_h - rise * horizon_d), d0, d1);
      const f64x8 from = select(hides0, out, d0);
      const mask8 raised = where & ~facing & (d0 > 0.0) & ~hides0;
      const unsigned seen = movemask(rises & (from < d1) & (width > 0.0));
      horizon_d = select(rises, d1, select(raised, d0, horizon_d));
      horizon_h = select(rises, h1, select(raised, h0, horizon_h));
      if (seen == 0) return;
      const f64x8 slope_x = cut.per_i * cells_per_m;
      const f64x8 slope_z = cut.per_j * cells_per_m;
      const f64x8 steepness = sqrt(1.0 + slope_x * slope_x + slope_z * slope_z);
      pieces.seen[n] = seen;
      store(pieces.from_m[n], from);
      store(pieces.to_m[n], d1);
      store(pieces.start_m[n], start);
      store(pieces.rise[n], rise);
      store(pieces.plane_distance_m[n], -start / steepness);
      store(pieces.width_rad[n], width);
      store(pieces.cell[n], cell);
      ++n;
    };
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, active, active & (ends.nearest <= to), end, cells);
  }
  store_cells(lanes, cells);
  store(lanes.horizon_d_m, horizon_d);
  store(lanes.horizon_h_m, horizon_h);
  pieces.n = n;
  return left;
}

}  // namespace obliq::OBLIQ_ISA
