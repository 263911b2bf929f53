// GroundWalk and SweepPlane over bare ground for eight planes at a time, to the bit.
#include "server/radar/ground_lanes.h"

#include "server/radar/lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kInfinity = __builtin_inf();

/// What stays the same all along.
struct Planes {
  Lanes sin, cos, per_x, per_z, rate_u, rate_v, end_m, step_i, step_j, ahead_i, ahead_j;
};

OBLIQ_LANES Planes planes_of(const GroundScene& scene, const GroundLanes& lanes) {
  Planes p;
  p.sin = load_lanes(lanes.sin_bearing);
  p.cos = load_lanes(lanes.cos_bearing);
  p.per_x = select(p.sin != 0.0, 1.0 / p.sin, all_lanes(kInfinity));
  p.per_z = select(p.cos != 0.0, 1.0 / p.cos, all_lanes(kInfinity));
  p.rate_u = p.sin / scene.grid.cell_m;
  p.rate_v = p.cos / scene.grid.cell_m;
  p.end_m = load_lanes(lanes.end_m);
  p.ahead_i = select(p.sin > 0.0, all_lanes(1), Lanes{});
  p.ahead_j = select(p.cos > 0.0, all_lanes(1), Lanes{});
  p.step_i = 2.0 * p.ahead_i - 1.0;
  p.step_j = 2.0 * p.ahead_j - 1.0;
  return p;
}

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
  const Planes p = planes_of(scene, lanes);
  const double start_u = (scene.antenna_x_m - grid.x0_m) / grid.cell_m;
  const double start_v = (scene.antenna_z_m - grid.z0_m) / grid.cell_m;
  const double cells_per_m = 1 / grid.cell_m;
  const Lanes rate = p.rate_u + p.rate_v;
  Lanes d = load_lanes(lanes.d_m);
  Lanes i = load_lanes(lanes.i);
  Lanes j = load_lanes(lanes.j);
  Lanes horizon_d = load_lanes(lanes.horizon_d_m);
  Lanes horizon_h = load_lanes(lanes.horizon_h_m);
  Lanes width = load_lanes(lanes.width_rad);
  Lanes width_to = load_lanes(lanes.width_to_m);
  int n = pieces.n;
  bool left = false;
  while (true) {
    const LaneFlags active = (d < p.end_m) & (d <= scene.last_start_m) & (i >= 0.0) & (j >= 0.0) &
                             (i < static_cast<double>(grid.nx - 1)) & (j < static_cast<double>(grid.nz - 1));
    if (!any(active)) break;
    if (n > GroundPieces::kMost - 2) {
      left = true;
      break;
    }
    if (const unsigned ended = mask_of(active & (width_to <= d)); ended != 0)
      next_widths(ended, lanes, d, width, width_to);

    // The cell, up to its end or to where the width changes.
    const Lanes to = least(width_to, p.end_m);
    const Lanes to_x =
        select(p.sin != 0.0, (grid.x0_m + (i + p.ahead_i) * grid.cell_m - scene.antenna_x_m) * p.per_x,
               all_lanes(kInfinity));
    const Lanes to_z =
        select(p.cos != 0.0, (grid.z0_m + (j + p.ahead_j) * grid.cell_m - scene.antenna_z_m) * p.per_z,
               all_lanes(kInfinity));
    const Lanes cell_end = least(to_x, to_z);
    const Lanes end = greatest(d, least(cell_end, to));
    const Lanes cell = select(active, j * static_cast<double>(grid.nx) + i, Lanes{});
    const LaneBits at = integers_of(cell);
    const LaneBits above = at + static_cast<std::uint64_t>(grid.nx);
    const Lanes y00 = gather(grid.y_m, at);
    const Lanes y10 = gather(grid.y_m, at + 1);
    const Lanes y01 = gather(grid.y_m, above);
    const Lanes y11 = gather(grid.y_m, above + 1);
    const Lanes all_four = (y00 + y10) + (y01 + y11);
    const LaneFlags known = active & (all_four == all_four);

    // Position in the cell at d = 0; its triangles meet where the two add up to 1.
    const Lanes s = start_u - i;
    const Lanes t = start_v - j;
    const Lanes sum0 = s + t + d * rate;
    const Lanes sum1 = s + t + end * rate;
    const LaneFlags both = (sum0 < 1.0) != (sum1 < 1.0);
    const Lanes diagonal = clamp((1.0 - s - t) / rate, d, end);

    const auto triangle = [&](LaneFlags where, LaneFlags upper, Lanes d0, Lanes d1)
        __attribute__((always_inline)) {
      where &= d1 > d0;
      const Lanes per_x = select(upper, y11 - y01, y10 - y00);
      const Lanes per_z = select(upper, y11 - y10, y01 - y00);
      const Lanes start =
          select(upper, y11 + per_x * (s - 1.0) + per_z * (t - 1.0), y00 + per_x * s + per_z * t) -
          scene.antenna_y_m;
      const Lanes rise = per_x * p.rate_u + per_z * p.rate_v;
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
      const Lanes slope_x = per_x * cells_per_m;
      const Lanes slope_z = per_z * cells_per_m;
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
    const LaneFlags two = known & both;
    triangle(known, select(both, sum0, sum0 + sum1) > select(both, sum1, all_lanes(2)), d,
             select(both, diagonal, end));
    if (any(two)) triangle(two, sum0 < sum1, diagonal, end);

    const LaneFlags leaves = active & (cell_end <= to);
    i = select(leaves & (to_x < to_z), i + p.step_i, i);
    j = select(leaves & ~(to_x < to_z), j + p.step_j, j);
    d = select(active, end, d);
  }
  store_lanes(lanes.d_m, d);
  store_lanes(lanes.i, i);
  store_lanes(lanes.j, j);
  store_lanes(lanes.horizon_d_m, horizon_d);
  store_lanes(lanes.horizon_h_m, horizon_h);
  pieces.n = n;
  return left;
}

}  // namespace obliq::OBLIQ_ISA
