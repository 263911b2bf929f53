// First hits on bare ground of rays that each go their own way. Eight walk at a time, and those that have
// their answer make room for others.
#include "server/radar/simd/free_ray_hits.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Rays on their way. A profile's bearing is a ray's whole direction here, so that it walks by slant range.
struct Walkers : WalkingProfiles {
  double dir_y[kLanes];
  int ray[kLanes];
};

constexpr int kRefill = 5;  // idle lanes that are worth a stop

/// Sets out rays in the lanes that are not in `busy`; returns those that are now.
unsigned set_out(const FreeRays& rays, int& next, unsigned busy, Walkers& walkers) {
  // A component that is all but 0 is none: its reciprocal would be infinite.
  const auto component = [](double c) { return c < 1e-200 && c > -1e-200 ? 0.0 : c; };
  for (int lane = 0; lane < kLanes && next < rays.n; ++lane) {
    if ((busy >> lane & 1) != 0) continue;
    const int ray = rays.order[next++];
    walkers.sin_bearing[lane] = component(rays.dir_x[ray]);
    walkers.cos_bearing[lane] = component(rays.dir_z[ray]);
    walkers.dir_y[lane] = rays.dir_y[ray];
    walkers.d_m[lane] = rays.from_m[ray];
    // Below all ground nothing is met from above. A metre more, for flat ground.
    const double to_m = (rays.lowest_m - 1) / rays.dir_y[ray];
    walkers.end_m[lane] = rays.dir_y[ray] < 0 && to_m < rays.reach_m ? to_m : rays.reach_m;
    walkers.ray[lane] = ray;
    busy |= 1u << lane;
  }
  return busy;
}

}  // namespace

void first_hits_on_ground(const GroundView& scene, const FreeRays& rays) {
  const GridView& grid = scene.grid;
  Walkers walkers{};
  ProfileRates<f64x8> p{};
  Cells<f64x8> cells{};
  f64x8 dir_y{};
  f64x8 end_m{};
  f64x8 cells_left{};
  mask8 above{};  // over known ground at the end of the last segment of it
  unsigned busy = 0;
  for (int next = 0;;) {
    if (next < rays.n && __builtin_popcount(busy) <= kLanes - kRefill) {
      store_cells(walkers, cells);
      const mask8 before = mask_from(busy);
      busy = set_out(rays, next, busy, walkers);
      p = rates_of(scene, walkers);
      cells = cells_of(walkers);
      dir_y = load(walkers.dir_y);
      end_m = load(walkers.end_m);
      const f64x8 i = clamp(floor(p.start_u + cells.d * p.rate_u), f64x8{}, broadcast(grid.nx - 2));
      const f64x8 j = clamp(floor(p.start_v + cells.d * p.rate_v), f64x8{}, broadcast(grid.nz - 2));
      cells.i = select(before, cells.i, i);
      cells.j = select(before, cells.j, j);
      cells_left = select(before, cells_left, broadcast(rays.most_cells));
      above &= before;
    }
    if (busy == 0) break;
    const mask8 active = mask_from(busy) & (cells.d < end_m) & cells.on(grid);
    const CellEnds<f64x8> ends = ends_of(scene, p, cells);
    const f64x8 end = max(cells.d, min(ends.nearest, end_m));
    const Corners<f64x8> y = corners(grid, to_u64(number_of(grid, cells, active)));
    mask8 open = active;
    f64x8 range = broadcast(__builtin_nan(""));
    // Behind a void a ray may be below the ground: it goes on until it meets some from above.
    const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
        __attribute__((always_inline)) {
      const f64x8 start = cut.start - scene.antenna_y_m;
      const mask8 below0 = dir_y * d0 < start + cut.rise * d0;
      const mask8 below1 = dir_y * d1 < start + cut.rise * d1;
      // Where it was above it has met the edge between.
      const mask8 hit = where & open & ((below0 & above) | (~below0 & below1 & (start < 0.0)));
      range = select(hit, select(below0, d0, clamp(start / (dir_y - cut.rise), d0, d1)), range);
      open &= ~hit;
      above = (where & ~below1) | (~where & above);
    };
    above &= y.known;
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, open, open & (ends.nearest <= end_m), end, cells);
    cells_left -= 1.0;
    const mask8 out_of_steps = open & (cells_left <= 0.0);
    range = select(out_of_steps, broadcast(FreeRays::kOutOfSteps), range);
    const unsigned left = movemask(open & ~out_of_steps);
    for (unsigned mask = busy & ~left; mask != 0; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      rays.range_m[walkers.ray[lane]] = range[lane];
      rays.from_m[walkers.ray[lane]] = cells.d[lane];
    }
    busy = left;
  }
}

}  // namespace obliq::OBLIQ_ISA
