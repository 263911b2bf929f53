// GroundWalk and SweepPlane over bare ground for eight planes at a time, to the bit.
#include "server/radar/simd/visible_ground.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Moves lanes whose width ends where they stand on to the next one.
OBLIQ_LANES void next_widths(unsigned mask, GroundLanes& lanes, Lanes d, Lanes& width, Lanes& width_to) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((mask >> lane & 1) == 0) continue;
    double to = width_to[lane];
    while (to <= d[lane]) {
      lanes.width_rad[lane] = *lanes.next_width_rad[lane]++;
      to = *lanes.next_width_to_m[lane]++;
    }
    lanes.width_to_m[lane] = to;
  }
  width = load_lanes(lanes.width_rad);
  width_to = load_lanes(lanes.width_to_m);
}

}  // namespace

bool march_ground(const GroundScene& scene, GroundLanes& lanes, GroundPieces& pieces) {
  const LaneGrid& grid = scene.grid;
  const PlaneRates p = plane_rates(scene, lanes);
  const double cells_per_m = 1 / grid.cell_m;
  const Lanes end_m = load_lanes(lanes.end_m);
  Cells cells = cells_of(lanes);
  Lanes horizon_d = load_lanes(lanes.horizon_d_m);
  Lanes horizon_h = load_lanes(lanes.horizon_h_m);
  Lanes width = load_lanes(lanes.width_rad);
  Lanes width_to = load_lanes(lanes.width_to_m);
  int n = pieces.n;
  bool left = false;
  while (true) {
    const LaneFlags active = (cells.d < end_m) & (cells.d <= scene.last_start_m) & cells.on(grid);
    if (!any(active)) break;
    if (n > GroundPieces::kMost - 2) {
      left = true;
      break;
    }
    if (const unsigned ended = mask_of(active & (width_to <= cells.d)); ended != 0)
      next_widths(ended, lanes, cells.d, width, width_to);

    // The cell, up to its end or to where the width changes.
    const Lanes to = least(width_to, end_m);
    const CellEnds ends = cell_ends(scene, p, cells);
    const Lanes end = greatest(cells.d, least(ends.nearest, to));
    const Lanes cell = cells.number(grid, active);
    const Corners y = corners(grid, integers_of(cell));
    prefetch_ahead(grid, p, cells);
    const auto triangle = [&](LaneFlags where, const TriangleCut& cut, Lanes d0, Lanes d1)
        __attribute__((always_inline)) {
      const Lanes start = cut.start - scene.antenna_y_m;
      const Lanes rise = cut.rise;
      const Lanes h0 = start + rise * d0;
      const Lanes h1 = start + rise * d1;
      // Facing when the antenna is above the triangle's plane: then elevation rises along it.
      const LaneFlags facing = where & (start < 0.0);
      const LaneFlags hides0 = h0 * horizon_d < horizon_h * d0;
      const LaneFlags rises = facing & ~(h1 * horizon_d < horizon_h * d1);
      const Lanes out = clamp(start * horizon_d / (horizon_h - rise * horizon_d), d0, d1);
      const Lanes from = select(hides0, out, d0);
      const LaneFlags raised = where & ~facing & (d0 > 0.0) & ~hides0;
      const unsigned seen = mask_of(rises & (from < d1) & (width > 0.0));
      horizon_d = select(rises, d1, select(raised, d0, horizon_d));
      horizon_h = select(rises, h1, select(raised, h0, horizon_h));
      if (seen == 0) return;
      const Lanes slope_x = cut.per_i * cells_per_m;
      const Lanes slope_z = cut.per_j * cells_per_m;
      const Lanes steepness = sqrt_of(1.0 + slope_x * slope_x + slope_z * slope_z);
      pieces.seen[n] = seen;
      store_lanes(pieces.from_m[n], from);
      store_lanes(pieces.to_m[n], d1);
      store_lanes(pieces.start_m[n], start);
      store_lanes(pieces.rise[n], rise);
      store_lanes(pieces.plane_distance_m[n], -start / steepness);
      store_lanes(pieces.width_rad[n], width);
      store_lanes(pieces.cell[n], cell);
      ++n;
    };
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, active, active & (ends.nearest <= to), end, cells);
  }
  store_cells(lanes, cells);
  store_lanes(lanes.horizon_d_m, horizon_d);
  store_lanes(lanes.horizon_h_m, horizon_h);
  pieces.n = n;
  return left;
}

}  // namespace obliq::OBLIQ_ISA
