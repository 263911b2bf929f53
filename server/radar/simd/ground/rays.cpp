#include "server/radar/simd/ground/rays.h"

#include "server/radar/simd/ground/grid_walk.h"
#include "server/radar/simd/lanes/lanes.h"
#include "server/scene/ground_triangle.h"

namespace obliq::OBLIQ_ISA {

// Rays through the pixels of a perspective frustum, eight at a time.

int pixel_rays(const PixelCamera& camera, const PixelList& pixels, const PixelRays& rays) {
  const f64x8 numbers = lane_numbers<double, kLanes>();
  const f64x8 lowest = broadcast(-1);
  int n = 0;
  for (int k = 0; k < pixels.n; k += kLanes) {
    const f64x8 x = camera.left_m + (load(pixels.column + k) + 0.5) * camera.pixel_width_m;
    const f64x8 y = load(pixels.up_m + k);
    const f64x8 z = load(pixels.ahead_m + k);
    const f64x8 length2 = x * x + y * y + z * z;
    const f64x8 length = sqrt(length2);
    const f64x8 up = y / length;
    mask8 reached = camera.swath.reaches(up);
    if (camera.half_pixel_m > 0)
      reached |= camera.swath.reaches(max(lowest, y / (length + camera.half_pixel_m))) |
                 camera.swath.reaches(max(lowest, y / max(f64x8{}, length - camera.half_pixel_m)));
    const f64x8 number = numbers + static_cast<double>(k);
    const unsigned mask = movemask(reached & (number < static_cast<double>(pixels.n)));
    const f64x8 right = x / length;
    const f64x8 ahead = z / length;
    const f64x8 solid_angle = select(length2 < camera.wide_m2, broadcast(__builtin_nan("")),
                                     camera.solid_angle_m3 / (length2 * length));
    store(rays.dir_x + n, compress(mask, right * camera.cos_bearing + ahead * camera.sin_bearing));
    store(rays.dir_y + n, compress(mask, up));
    store(rays.dir_z + n, compress(mask, ahead * camera.cos_bearing - right * camera.sin_bearing));
    store(rays.solid_angle_sr + n, compress(mask, solid_angle));
    store_i32(rays.from + n, compress(mask, number));
    n += __builtin_popcount(mask);
  }
  return n;
}

// First hits on bare ground of rays that each go their own way. Eight walk at a time, and those that have
// their answer make room for others.

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

// refine_near of server/scene/exact_hit.h for eight rays at a time, to the bit.

namespace {

/// Eight rays while the triangles that they meet are looked for.
struct Search {
  f64x8 distance;  // where to look next
  f64x8 range;     // found; NaN until then
  f64x8 cos_incidence;
  f64x8 i, j;
  mask8 open;
};

/// Intersects the plane of the triangle under `distance`: found, or where to look next.
OBLIQ_INLINE void step(const GroundView& view, f64x8 dx, f64x8 dy, f64x8 dz, Search& search) {
  const GridView& grid = view.grid;
  const f64x8 u = (view.antenna_x_m + search.distance * dx - grid.x0_m) / grid.cell_m;
  const f64x8 v = (view.antenna_z_m + search.distance * dz - grid.z0_m) / grid.cell_m;
  const mask8 near = (u > -1.0) & (v > -1.0) & (u < static_cast<double>(grid.nx)) &
                     (v < static_cast<double>(grid.nz)) & search.open;
  const f64x8 i = clamp(floor(select(near, u, f64x8{})), f64x8{}, broadcast(grid.nx - 2));
  const f64x8 j = clamp(floor(select(near, v, f64x8{})), f64x8{}, broadcast(grid.nz - 2));
  const auto [y00, y10, y01, y11, known] = corners(grid, j * static_cast<double>(grid.nx) + i);
  const mask8 upper = (u - i) + (v - j) > 1.0;

  const GroundTriangle<f64x8> triangle(grid, i, j, upper, y00, y10, y01, y11);
  const f64x8 descent = triangle.descent(dx, dy, dz);
  const mask8 lit = near & known & (descent < 0.0);
  const f64x8 distance =
      -triangle.height_above(view.antenna_x_m, view.antenna_y_m, view.antenna_z_m) / descent;
  const mask8 inside =
      triangle.holds(view.antenna_x_m + distance * dx, view.antenna_z_m + distance * dz) & (distance > 0.0);

  const mask8 found = lit & inside;
  search.range = select(found, distance, search.range);
  search.cos_incidence =
      select(found, min(broadcast(1), -descent / sqrt(triangle.steepness2())), search.cos_incidence);
  search.i = select(found, i, search.i);
  search.j = select(found, j, search.j);
  search.open = lit & ~inside;
  search.distance = distance;
}

/// Asks for the heights under rays [k, k + 8), wherever exactly the tracer's distance leads.
OBLIQ_INLINE void ask_for_heights(const RoughHits& rays, int k, double per_cell) {
  const GroundView& view = rays.view;
  const GridView& grid = view.grid;
  const f64x8 rough = load(rays.rough_m + k);
  const f64x8 u = (view.antenna_x_m - grid.x0_m + rough * load(rays.dir_x + k)) * per_cell;
  const f64x8 v = (view.antenna_z_m - grid.z0_m + rough * load(rays.dir_z + k)) * per_cell;
  prefetch_cells(grid, u, v);
}

}  // namespace

void refine_ground_hits(const RoughHits& rays, GroundHits& hits) {
  constexpr int kAhead = 8 * kLanes;
  const GroundView& view = rays.view;
  const double per_cell = 1 / view.grid.cell_m;
  for (int k = 0; k < kAhead && k < rays.n; k += kLanes) ask_for_heights(rays, k, per_cell);
  const f64x8 none = broadcast(__builtin_nan(""));
  for (int k = 0; k < rays.n; k += kLanes) {
    if (k + kAhead < rays.n) ask_for_heights(rays, k + kAhead, per_cell);
    const f64x8 dx = load(rays.dir_x + k);
    const f64x8 dy = load(rays.dir_y + k);
    const f64x8 dz = load(rays.dir_z + k);
    const f64x8 rough = load(rays.rough_m + k);
    Search search{rough, none, f64x8{}, f64x8{}, f64x8{}, rough == rough};
    step(view, dx, dy, dz, search);
    const f64x8 off = search.distance - rough;
    const double reach = 4 * view.grid.cell_m;
    search.open &= (off < reach) & (off > -reach);
    if (any(search.open)) step(view, dx, dy, dz, search);
    store(hits.slant_range_m + k, search.range);
    store(hits.cos_incidence + k, search.cos_incidence);
    store(hits.x_m + k, view.antenna_x_m + search.range * dx);
    store(hits.z_m + k, view.antenna_z_m + search.range * dz);
    store_i32(hits.cell_x + k, search.i);
    store_i32(hits.cell_z + k, search.j);
  }
}

}  // namespace obliq::OBLIQ_ISA
