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
  f64x8 number{};
  int n = segments.n;
  bool left = false;
  const auto next = [&](mask8 active, const CellEnds<f64x8>& /*ends*/, f64x8& to)
      __attribute__((always_inline)) {
    active &= cells.d <= lanes.last_start_m;
    if (n > VisibleSegments::kMost - 2) {
      left = any(active);
      return mask8{};
    }
    if (const unsigned ended = movemask(active & (width_to <= cells.d)); ended != 0)
      next_widths(ended, lanes, cells.d, width, width_to);
    to = min(width_to, end_m);
    return active;
  };
  const auto cell = [&](mask8 /*active*/, mask8 /*known*/, f64x8 at, f64x8 /*end*/)
      __attribute__((always_inline)) {
    number = at;
    prefetch_ahead(grid, p, cells);
  };
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
    store(segments.cell[n], number);
    ++n;
  };
  march(scene, p, end_m, cells, next, cell, triangle);
  store_cells(lanes, cells);
  store(lanes.horizon_d_m, horizon.d_m);
  store(lanes.horizon_h_m, horizon.h_m);
  segments.n = n;
  return left;
}

}  // namespace obliq::OBLIQ_ISA
