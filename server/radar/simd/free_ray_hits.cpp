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
  Cells<f64x8> cells{};
  f64x8 cells_left{};
  mask8 above{};  // over known ground at the end of the last segment of it
  unsigned busy = 0;
  for (int next_ray = 0;;) {
    store_cells(walkers, cells);
    const mask8 before = mask_from(busy);
    busy = set_out(rays, next_ray, busy, walkers);
    if (busy == 0) break;
    const ProfileRates<f64x8> p = rates_of(scene, walkers);
    const f64x8 dir_y = load(walkers.dir_y);
    const f64x8 end_m = load(walkers.end_m);
    cells = cells_of(walkers);
    const f64x8 i = clamp(floor(p.start_u + cells.d * p.rate_u), f64x8{}, broadcast(grid.nx - 2));
    const f64x8 j = clamp(floor(p.start_v + cells.d * p.rate_v), f64x8{}, broadcast(grid.nz - 2));
    cells.i = select(before, cells.i, i);
    cells.j = select(before, cells.j, j);
    cells_left = select(before, cells_left, broadcast(rays.most_cells));
    above &= before;
    mask8 open = mask_from(busy);
    f64x8 range = broadcast(__builtin_nan(""));

    // Writes down the answers of the rays that have come to their end, and stops for others to take their
    // lanes.
    const auto next = [&](mask8 active, const CellEnds<f64x8>& /*ends*/, f64x8& /*to*/)
        __attribute__((always_inline)) {
      const mask8 out_of_steps = open & (cells_left <= 0.0);
      range = select(out_of_steps, broadcast(FreeRays::kOutOfSteps), range);
      open &= active & ~out_of_steps;
      const unsigned left = movemask(open);
      for (unsigned mask = busy & ~left; mask != 0; mask &= mask - 1) {
        const int lane = __builtin_ctz(mask);
        rays.range_m[walkers.ray[lane]] = range[lane];
        rays.from_m[walkers.ray[lane]] = cells.d[lane];
      }
      busy = left;
      return next_ray < rays.n && __builtin_popcount(busy) <= kLanes - kRefill ? mask8{} : open;
    };
    const auto cell = [&](mask8 /*active*/, mask8 known, f64x8 /*number*/, f64x8 /*end*/)
        __attribute__((always_inline)) {
      above &= known;
      cells_left -= 1.0;
    };
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
    march(scene, p, end_m, cells, next, cell, triangle);
  }
}

}  // namespace obliq::OBLIQ_ISA
