#include "server/radar/simd/ground/profiles.h"

#include "server/radar/simd/ground/grid_walk.h"
#include "server/radar/simd/ground/horizon.h"
#include "server/radar/simd/lanes/lanes.h"
#include "server/scene/tolerances.h"

namespace obliq::OBLIQ_ISA {

// LineOfSight over bare ground for eight profiles at a time.

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
  const f64x8 ahead = nodes_ahead(grid, p);
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
    prefetch_ahead(grid, at, ahead);
  };
  const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
      __attribute__((always_inline)) {
    const f64x8 start = cut.start - scene.antenna_y_m;
    const f64x8 rise = cut.rise;
    const auto sight = horizon.pass(where, start, rise, d0, d1, where);
    const unsigned seen = movemask(sight.any & (width > 0.0));
    if (seen == 0) return;
    segments.seen[n] = seen;
    store(segments.from_m[n], sight.from);
    store(segments.to_m[n], d1);
    store(segments.start_m[n], start);
    store(segments.rise[n], rise);
    if (segments.wants_planes) {
      const f64x8 slope_x = cut.per_i * cells_per_m;
      const f64x8 slope_z = cut.per_j * cells_per_m;
      store(segments.plane_distance_m[n], -start / sqrt(1.0 + slope_x * slope_x + slope_z * slope_z));
    }
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

// RangeMarch over bare ground for eight profiles at a time.

namespace {

/// Marks the bins of the lanes' runs and empties them.
OBLIQ_INLINE void close(RangeRun<f64x8>& run, mask8 where, const RangeAxis& bins,
                        std::uint8_t* const* marks) {
  where &= run.greatest2 >= 0.0;
  if (!any(where)) return;
  const f64x8 low = sqrt(run.least2);
  const f64x8 high = sqrt(run.greatest2);
  // mark_bins for all of them at once.
  double first[kLanes];
  double last[kLanes];
  store(first, select(low < bins.r_min_m, f64x8{}, bins.bin(low)));
  store(last, select(high >= bins.r_max_m, broadcast(bins.n_range - 1.0), bins.bin(high)));
  for (unsigned mask = movemask(where & (high >= bins.r_min_m) & (low < bins.r_max_m)); mask != 0;
       mask &= mask - 1) {
    const int lane = __builtin_ctz(mask);
    for (auto bin = static_cast<int>(first[lane]); bin <= static_cast<int>(last[lane]); ++bin)
      marks[lane][bin] = 1;
  }
  run.clear(where);
}

/// Member `part` of the lanes' states.
#define OBLIQ_LOAD(part)                     \
  lane_by_lane<double, kLanes>([&](int lane) \
                                   __attribute__((always_inline)) { return lanes.state[lane].part; })

}  // namespace

unsigned mark_visible_ranges(const GroundView& scene, const RangeAxis& bins, RangeProfiles& lanes) {
  const ProfileRates<f64x8> p = rates_of(scene, lanes);
  const f64x8 ahead = nodes_ahead(scene.grid, p);
  const f64x8 end_m = load(lanes.end_m);
  const f64x8 roof_m = load(lanes.roof_m);
  Cells<f64x8> cells = cells_of(lanes);
  ProfileState<f64x8> state{{OBLIQ_LOAD(horizon.d_m), OBLIQ_LOAD(horizon.h_m), mask8{}},
                            {OBLIQ_LOAD(visible.least2), OBLIQ_LOAD(visible.greatest2)},
                            {OBLIQ_LOAD(present.least2), OBLIQ_LOAD(present.greatest2)},
                            OBLIQ_LOAD(last_h_m),
                            OBLIQ_LOAD(joined ? 1.0 : 0.0) != 0.0};
  unsigned at_roof = 0;
  const auto next = [&](mask8 active, const CellEnds<f64x8>& ends, f64x8& to) __attribute__((always_inline)) {
    at_roof = movemask(active & (roof_m <= max(cells.d, min(ends.nearest, to))));
    return at_roof != 0 ? mask8{} : active;
  };
  const auto cell = [&](mask8 active, mask8 known, f64x8 number, f64x8 /*end*/)
      __attribute__((always_inline)) {
    prefetch_ahead(scene.grid, number, ahead);
    if (const mask8 gap = active & ~known; any(gap)) {
      close(state.visible, gap, bins, lanes.visible);
      close(state.present, gap, bins, lanes.present);
      state.joined &= ~gap;
    }
  };
  const auto close_visible = [&](mask8 where) __attribute__((always_inline)) {
    close(state.visible, where, bins, lanes.visible);
  };
  const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
      __attribute__((always_inline)) {
    state.pass(where, cut.start - scene.antenna_y_m, cut.rise, d0, d1, close_visible);
  };
  march(scene, p, end_m, cells, next, cell, triangle);
  store_cells(lanes, cells);
  const unsigned joined = movemask(state.joined);
  for (int lane = 0; lane < kLanes; ++lane)
    lanes.state[lane] = {{state.horizon.d_m[lane], state.horizon.h_m[lane], false},
                         {state.visible.least2[lane], state.visible.greatest2[lane]},
                         {state.present.least2[lane], state.present.greatest2[lane]},
                         state.last_h_m[lane],
                         (joined >> lane & 1) != 0};
  return at_roof;
}

// The ground's height at eight crossings of a profile with the mesh's edges at a time. The edges are three
// families of parallel lines: x, z and x + z whole, in cells.

namespace {

/// Along a stretch, in cells: where the antenna is and how fast x, z grow with ground distance.
struct Line {
  double start_u, start_v, rate_u, rate_v;
};

struct Highest {
  f64x8 slope = broadcast(-__builtin_inf());
  f64x8 d{};
  f64x8 h{};

  OBLIQ_INLINE void raise(mask8 where, f64x8 at_d, f64x8 at_h) {
    const f64x8 at_slope = at_h / at_d;
    const mask8 higher = where & (at_d > 0.0) & (at_slope > slope);
    slope = select(higher, at_slope, slope);
    d = select(higher, at_d, d);
    h = select(higher, at_h, h);
  }
};

OBLIQ_INLINE f64x8 cell_of(f64x8 at, int nodes) { return clamp(floor(at), f64x8{}, broadcast(nodes - 2.0)); }

/// The crossings with one family: `start` and `rate` say how its number grows along the profile.
/// heights(number, d): of the ground at the crossing.
template <class Heights>
OBLIQ_INLINE void cross(const ProfileStretch& along, double start, double rate, double least_number,
                        double most_number, double antenna_y_m, Highest& highest, const Heights& heights) {
  if (rate == 0) return;
  const double a = start + along.from_m * rate;
  const double b = start + along.to_m * rate;
  double first = __builtin_ceil((a < b ? a : b) - kCrossingMargin_cells);
  double last = __builtin_floor((a < b ? b : a) + kCrossingMargin_cells);
  if (first < least_number) first = least_number;
  if (last > most_number) last = most_number;
  for (; first <= last; first += kLanes) {
    const f64x8 number = first + lane_numbers<double, kLanes>();
    const mask8 inside = number <= last;
    const f64x8 capped = select(inside, number, broadcast(last));
    // A profile that runs along a line of the family meets it anywhere.
    const f64x8 d = clamp((capped - start) / rate, broadcast(along.from_m), broadcast(along.to_m));
    highest.raise(inside, d, heights(capped, d) - antenna_y_m);
  }
}

}  // namespace

HorizonPoint highest_ground(const GroundView& scene, const ProfileStretch& along) {
  const GridView& grid = scene.grid;
  const Line line{(scene.antenna_x_m - grid.x0_m) / grid.cell_m,
                  (scene.antenna_z_m - grid.z0_m) / grid.cell_m, along.sin_bearing / grid.cell_m,
                  along.cos_bearing / grid.cell_m};
  const double nx = grid.nx;
  const auto between = [&](f64x8 from, f64x8 to, f64x8 share) __attribute__((always_inline)) {
    const f64x8 low = gather(grid.y_m, to_u64(from));
    return low + share * (gather(grid.y_m, to_u64(to)) - low);
  };
  Highest highest;
  cross(
      along, line.start_u, line.rate_u, 0, nx - 1, scene.antenna_y_m,
      highest, [&](f64x8 i, f64x8 d) __attribute__((always_inline)) {
        const f64x8 v = line.start_v + d * line.rate_v;
        const f64x8 j = cell_of(v, grid.nz);
        return between(j * nx + i, (j + 1.0) * nx + i, v - j);
      });
  cross(
      along, line.start_v, line.rate_v, 0, grid.nz - 1.0, scene.antenna_y_m,
      highest, [&](f64x8 j, f64x8 d) __attribute__((always_inline)) {
        const f64x8 u = line.start_u + d * line.rate_u;
        const f64x8 i = cell_of(u, grid.nx);
        return between(j * nx + i, j * nx + i + 1.0, u - i);
      });
  cross(
      along, line.start_u + line.start_v, line.rate_u + line.rate_v, 1, nx + grid.nz - 3, scene.antenna_y_m,
      highest, [&](f64x8 sum, f64x8 d) __attribute__((always_inline)) {
        const f64x8 u = line.start_u + d * line.rate_u;
        const f64x8 i = clamp(cell_of(u, grid.nx), sum - (grid.nz - 1.0), sum - 1.0);
        const f64x8 j = sum - 1.0 - i;
        return between((j + 1.0) * nx + i, j * nx + i + 1.0, u - i);
      });
  HorizonPoint point{0, 0};
  double slope = -__builtin_inf();
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!(highest.slope[lane] > slope)) continue;
    slope = highest.slope[lane];
    point = {highest.d[lane], highest.h[lane]};
  }
  return point;
}

}  // namespace obliq::OBLIQ_ISA
