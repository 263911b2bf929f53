// refine_near of server/scene/exact_hit.h for eight rays at a time, to the bit.
#include "server/radar/simd/refine_hits.h"

#include "server/radar/simd/grid_walk.h"
#include "server/scene/ground_triangle.h"

namespace obliq::OBLIQ_ISA {
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
