// refine_near of server/scene/exact_hit.h for eight rays at a time, to the bit.
#include "server/radar/simd/refine_hits.h"

#include "server/radar/simd/cell_prefetch.h"
#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kEdgeSlack_m = 1e-7;  // as in exact_hit.cpp, which says why

/// Eight rays while the triangles that they meet are looked for.
struct Search {
  Lanes distance;  // where to look next
  Lanes range;     // found; NaN until then
  Lanes cos_incidence;
  Lanes i, j;
  LaneFlags open;
};

/// Intersects the plane of the triangle under `distance`: found, or where to look next.
OBLIQ_LANES void step(const GroundRays& rays, Lanes dx, Lanes dy, Lanes dz, Search& search) {
  const LaneGrid& grid = rays.grid;
  const Lanes u = (rays.antenna_x_m + search.distance * dx - grid.x0_m) / grid.cell_m;
  const Lanes v = (rays.antenna_z_m + search.distance * dz - grid.z0_m) / grid.cell_m;
  const LaneFlags near = (u > -1.0) & (v > -1.0) & (u < static_cast<double>(grid.nx)) &
                         (v < static_cast<double>(grid.nz)) & search.open;
  const Lanes i = clamp(floor_of(select(near, u, Lanes{})), Lanes{}, all_lanes(grid.nx - 2));
  const Lanes j = clamp(floor_of(select(near, v, Lanes{})), Lanes{}, all_lanes(grid.nz - 2));
  const auto [y00, y10, y01, y11, known] = corners(grid, integers_of(j * static_cast<double>(grid.nx) + i));
  const LaneFlags upper = (u - i) + (v - j) > 1.0;

  const Lanes west = grid.x0_m + i * grid.cell_m;
  const Lanes south = grid.z0_m + j * grid.cell_m;
  const Lanes x0 = select(upper, grid.x0_m + (i + 1.0) * grid.cell_m, west);
  const Lanes z0 = select(upper, grid.z0_m + (j + 1.0) * grid.cell_m, south);
  const Lanes y0 = select(upper, y11, y00);
  const Lanes slope_x = (select(upper, y11, y10) - select(upper, y01, y00)) / grid.cell_m;
  const Lanes slope_z = (select(upper, y11, y01) - select(upper, y10, y00)) / grid.cell_m;

  const Lanes descent = dy - slope_x * dx - slope_z * dz;
  const LaneFlags lit = near & known & (descent < 0.0);
  const Lanes height =
      rays.antenna_y_m - y0 - slope_x * (rays.antenna_x_m - x0) - slope_z * (rays.antenna_z_m - z0);
  const Lanes distance = -height / descent;
  const Lanes s = (rays.antenna_x_m + distance * dx - west) / grid.cell_m;
  const Lanes t = (rays.antenna_z_m + distance * dz - south) / grid.cell_m;
  const double slack = kEdgeSlack_m / grid.cell_m;
  const LaneFlags in_upper = (s <= 1 + slack) & (t <= 1 + slack) & (s + t >= 1 - slack);
  const LaneFlags in_lower = (s >= -slack) & (t >= -slack) & (s + t <= 1 + slack);
  const LaneFlags inside = ((upper & in_upper) | (~upper & in_lower)) & (distance > 0.0);

  const LaneFlags found = lit & inside;
  const Lanes steepness = sqrt_of(1.0 + slope_x * slope_x + slope_z * slope_z);
  search.range = select(found, distance, search.range);
  search.cos_incidence = select(found, least(all_lanes(1), -descent / steepness), search.cos_incidence);
  search.i = select(found, i, search.i);
  search.j = select(found, j, search.j);
  search.open = lit & ~inside;
  search.distance = distance;
}

/// Asks for the heights under rays [k, k + 8), wherever exactly the tracer's distance leads.
OBLIQ_LANES void ask_for_heights(const GroundRays& rays, int k, double per_cell) {
  const LaneGrid& grid = rays.grid;
  const Lanes rough = load_lanes(rays.rough_m + k);
  const Lanes u = (rays.antenna_x_m - grid.x0_m + rough * load_lanes(rays.dir_x + k)) * per_cell;
  const Lanes v = (rays.antenna_z_m - grid.z0_m + rough * load_lanes(rays.dir_z + k)) * per_cell;
  prefetch_cells(grid, u, v);
}

}  // namespace

void meet_ground(const GroundRays& rays, GroundHits& hits) {
  constexpr int kAhead = 8 * kLanes;
  const double per_cell = 1 / rays.grid.cell_m;
  for (int k = 0; k < kAhead && k < rays.n; k += kLanes) ask_for_heights(rays, k, per_cell);
  const Lanes none = all_lanes(__builtin_nan(""));
  for (int k = 0; k < rays.n; k += kLanes) {
    if (k + kAhead < rays.n) ask_for_heights(rays, k + kAhead, per_cell);
    const Lanes dx = load_lanes(rays.dir_x + k);
    const Lanes dy = load_lanes(rays.dir_y + k);
    const Lanes dz = load_lanes(rays.dir_z + k);
    const Lanes rough = load_lanes(rays.rough_m + k);
    Search search{rough, none, Lanes{}, Lanes{}, Lanes{}, rough == rough};
    step(rays, dx, dy, dz, search);
    const Lanes off = search.distance - rough;
    const double reach = 4 * rays.grid.cell_m;
    search.open &= (off < reach) & (off > -reach);
    if (any(search.open)) step(rays, dx, dy, dz, search);
    store_lanes(hits.slant_range_m + k, search.range);
    store_lanes(hits.cos_incidence + k, search.cos_incidence);
    store_lanes(hits.x_m + k, rays.antenna_x_m + search.range * dx);
    store_lanes(hits.z_m + k, rays.antenna_z_m + search.range * dz);
    store_ints(hits.cell_x + k, search.i);
    store_ints(hits.cell_z + k, search.j);
  }
}

}  // namespace obliq::OBLIQ_ISA
