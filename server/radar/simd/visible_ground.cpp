// LineOfSight over bare ground for eight profiles at a time.
#include "server/radar/simd/visible_ground.h"

#include "server/radar/simd/grid_walk.h"
#include "server/radar/simd/horizon.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Moves lanes whose width ends where they stand on to the next one.
OBLIQ_INLINE void next_widths(unsigned mask, SightProfiles& lanes, f64x8 d, f64x8& width, f64x8& width_to) {
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

bool visible_ground(const GroundView& scene, SightProfiles& lanes, VisibleSegments& segments) {
  const GridView& grid = scene.grid;
  const ProfileRates<f64x8> p = rates_of(scene, lanes);
  const double cells_per_m = 1 / grid.cell_m;
  const f64x8 end_m = load(lanes.end_m);
  Cells<f64x8> cells = cells_of(lanes);
  Horizon<f64x8> horizon{load(lanes.horizon_d_m), load(lanes.horizon_h_m), mask8{}};
  f64x8 width = load(lanes.width_rad);
  f64x8 width_to = load(lanes.width_to_m);
  int n = segments.n;
  bool left = false;
  while (true) {
    const mask8 active = (cells.d < end_m) & (cells.d <= lanes.last_start_m) & cells.on(grid);
    if (!any(active)) break;
    if (n > VisibleSegments::kMost - 2) {
      left = true;
      break;
    }
    if (const unsigned ended = movemask(active & (width_to <= cells.d)); ended != 0)
      next_widths(ended, lanes, cells.d, width, width_to);

    // The cell, up to its end or to where the width changes.
    const f64x8 to = min(width_to, end_m);
    const CellEnds<f64x8> ends = ends_of(scene, p, cells);
    const f64x8 end = max(cells.d, min(ends.nearest, to));
    const f64x8 cell = number_of(grid, cells, active);
    const Corners<f64x8> y = corners(grid, to_u64(cell));
    prefetch_ahead(grid, p, cells);
    const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
        __attribute__((always_inline)) {
      const f64x8 start = cut.start - scene.antenna_y_m;
      const f64x8 rise = cut.rise;
      const auto sight = horizon.pass(where, start, rise, d0, d1, where);
      const unsigned seen = movemask(sight.any & (width > 0.0));
      if (seen == 0) return;
      const f64x8 slope_x = cut.per_i * cells_per_m;
      const f64x8 slope_z = cut.per_j * cells_per_m;
      const f64x8 steepness = sqrt(1.0 + slope_x * slope_x + slope_z * slope_z);
      segments.seen[n] = seen;
      store(segments.from_m[n], sight.from);
      store(segments.to_m[n], d1);
      store(segments.start_m[n], start);
      store(segments.rise[n], rise);
      store(segments.plane_distance_m[n], -start / steepness);
      store(segments.width_rad[n], width);
      store(segments.cell[n], cell);
      ++n;
    };
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, active, active & (ends.nearest <= to), end, cells);
  }
  store_cells(lanes, cells);
  store(lanes.horizon_d_m, horizon.d_m);
  store(lanes.horizon_h_m, horizon.h_m);
  segments.n = n;
  return left;
}

}  // namespace obliq::OBLIQ_ISA
