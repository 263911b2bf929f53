// First hits on bare ground of rays that each go their own way. Eight walk at a time, and those that have
// their answer make room for others.
#include "server/radar/cast_lanes.h"

#include "server/radar/cell_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Rays on their way. A plane's bearing is a ray's whole direction here, so that it walks by slant range.
struct Walkers : WalkingPlanes {
  double dir_y[kLanes];
  int ray[kLanes];
};

constexpr int kRefill = 5;  // idle lanes that are worth a stop

/// Sets out rays in the lanes that are not in `busy`; returns those that are now.
unsigned set_out(const CastRays& rays, int& next, unsigned busy, Walkers& walkers) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((busy >> lane & 1) != 0) continue;
    while (next < rays.n && !(rays.from_m[next] < __builtin_inf())) rays.range_m[next++] = __builtin_nan("");
    if (next == rays.n) break;
    walkers.sin_bearing[lane] = rays.dir_x[next];
    walkers.cos_bearing[lane] = rays.dir_z[next];
    walkers.dir_y[lane] = rays.dir_y[next];
    walkers.d_m[lane] = rays.from_m[next];
    walkers.ray[lane] = next++;
    busy |= 1u << lane;
  }
  return busy;
}

}  // namespace

void cast_ground(const GroundScene& scene, const CastRays& rays) {
  const LaneGrid& grid = scene.grid;
  Walkers walkers{};
  PlaneRates p{};
  Cells cells{};
  Lanes dir_y{};
  unsigned busy = 0;
  const Lanes end_m = all_lanes(scene.last_start_m);
  for (int next = 0;;) {
    if (next < rays.n && __builtin_popcount(busy) <= kLanes - kRefill) {
      store_cells(walkers, cells);
      const unsigned before = busy;
      busy = set_out(rays, next, busy, walkers);
      p = plane_rates(scene, walkers);
      cells = cells_of(walkers);
      dir_y = load_lanes(walkers.dir_y);
      const Lanes i = clamp(floor_of(p.start_u + cells.d * p.rate_u), Lanes{}, all_lanes(grid.nx - 2));
      const Lanes j = clamp(floor_of(p.start_v + cells.d * p.rate_v), Lanes{}, all_lanes(grid.nz - 2));
      const LaneFlags fresh = flags_of(busy & ~before);
      cells.i = select(fresh, i, cells.i);
      cells.j = select(fresh, j, cells.j);
    }
    if (busy == 0) break;
    const LaneFlags active = flags_of(busy) & (cells.d < end_m) & cells.on(grid);
    const CellEnds ends = cell_ends(scene, p, cells);
    const Lanes end = greatest(cells.d, least(ends.nearest, end_m));
    const Corners y = corners(grid, integers_of(cells.number(grid, active)));
    LaneFlags open = active;
    Lanes range = all_lanes(__builtin_nan(""));
    const auto triangle = [&](LaneFlags where, const TriangleCut& cut, Lanes d0, Lanes d1)
        __attribute__((always_inline)) {
      const Lanes start = cut.start - scene.antenna_y_m;
      const LaneFlags under = where & open & (dir_y * d0 < start + cut.rise * d0);
      const LaneFlags hit = where & open & ~under & (start < 0.0) & (dir_y * d1 < start + cut.rise * d1);
      range = select(under, all_lanes(CastRays::kUnder),
                     select(hit, clamp(start / (dir_y - cut.rise), d0, d1), range));
      open &= ~(under | hit);
    };
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, open, open & (ends.nearest <= end_m), end, cells);
    const unsigned left = mask_of(open);
    if (const unsigned done = busy & ~left; done != 0) {
      for (unsigned mask = done; mask != 0; mask &= mask - 1) {
        const int lane = __builtin_ctz(mask);
        rays.range_m[walkers.ray[lane]] = range[lane];
      }
      busy = left;
    }
  }
}

}  // namespace obliq::OBLIQ_ISA
