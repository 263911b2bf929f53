// First hits on bare ground of rays that lie in eight vertical profiles. The profiles walk side by side and
// note the triangles that rise above all that is nearer, with the slope up to which each does. The rays of a
// profile come in rising order, and so do these slopes: a ray meets the first triangle that rises above it.
// Neither loop has data-dependent branches.
#include "server/radar/simd/profile_ray_hits.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Triangles that the profiles have passed, a row for each that some profile sees.
struct Rises {
  static constexpr int kMost = 128;
  static constexpr int kMostOfCells = 4;  // two triangles, each with what passes under it
  using Row = double[kLanes];
  int n = 0;
  double slope[kLanes][kMost + kLanes];  // the greatest so far, of each profile by itself
  Row start[kMost];                      // height over the antenna = start + rise d, d from `from` to `to`
  Row rise[kMost];
  Row from[kMost];
  Row to[kMost];
  std::uint32_t surface[kMost][kLanes];
};

/// One profile's rays that lie below the last of its slopes.
struct Answers {
  const Rises& rises;
  const RayRows& rows;
  int lane;
  const double* slopes;
  double last;
  double* slant_range_m;
  std::uint32_t* surface;
  std::uint64_t ray;
  int k = 0;

  OBLIQ_INLINE Answers(const Rises& noted, const RayRows& all, int of_lane, const RayProfiles& lanes)
      : rises(noted),
        rows(all),
        lane(of_lane),
        slopes(noted.slope[of_lane]),
        last(slopes[noted.n - 1]),
        slant_range_m(lanes.slant_range_m + static_cast<std::uint64_t>(of_lane) * all.n),
        surface(lanes.surface + static_cast<std::uint64_t>(of_lane) * all.n),
        ray(lanes.next[of_lane]) {}

  OBLIQ_INLINE bool left() const { return rows.slope[ray] < last; }
  OBLIQ_INLINE void answer() {
    const double slope = rows.slope[ray];
    unsigned above = movemask(load(slopes + k) > slope);
    while (above == 0) above = movemask(load(slopes + (k += kLanes)) > slope);
    k += __builtin_ctz(above);
    const double d = rises.start[k][lane] / (slope - rises.rise[k][lane]);
    const double from = rises.from[k][lane];
    const double to = rises.to[k][lane];
    surface[ray] = rises.surface[k][lane];
    slant_range_m[ray] = (d < from ? from : to < d ? to : d) * rows.secant[ray];
    ++ray;
  }
};

/// Four profiles at a time: what one waits for, the others have time for.
OBLIQ_INLINE void answer(const Rises& rises, const RayRows& rows, RayProfiles& lanes) {
  for (int lane = 0; lane < kLanes; lane += 4) {
    Answers a(rises, rows, lane, lanes);
    Answers b(rises, rows, lane + 1, lanes);
    Answers c(rises, rows, lane + 2, lanes);
    Answers d(rises, rows, lane + 3, lanes);
    while (a.left() && b.left() && c.left() && d.left()) {
      a.answer();
      b.answer();
      c.answer();
      d.answer();
    }
    Answers* const all[] = {&a, &b, &c, &d};
    for (Answers* rest : all) {
      while (rest->left()) rest->answer();
      lanes.next[rest->lane] = rest->ray;
    }
  }
}

}  // namespace

unsigned first_hits_in_profiles(const GroundView& scene, const RayRows& rows, RayProfiles& lanes) {
  const GridView& grid = scene.grid;
  const ProfileRates<f64x8> p = rates_of(scene, lanes);
  const f64x8 end_m = load(lanes.end_m);
  const f64x8 roof_m = load(lanes.roof_m);
  const f64x8 infinite = broadcast(__builtin_inf());
  Cells<f64x8> cells = cells_of(lanes);
  const u64x8 next = load_u64(lanes.next);
  const mask8 some = next > 0;
  // All that is nearer lies below the next ray; where there is none, nothing is left to look for.
  f64x8 horizon = select(some, gather(rows.slope, select(some, next - 1, next)), -infinite);
  horizon = select(next >= rows.n, infinite, horizon);
  const f64x8 highest = broadcast(rows.n > 0 ? rows.slope[rows.n - 1] : -__builtin_inf());
  // Ground that begins higher than what is nearer leaves rays that pass under it: behind a void.
  mask8 beginning = cells.d == cells.d;
  Rises rises;
  const auto note = [&](f64x8 start, f64x8 rise, f64x8 from, f64x8 to, u64x8 surface)
      __attribute__((always_inline)) {
    const int n = rises.n++;
    for (int lane = 0; lane < kLanes; ++lane) rises.slope[lane][n] = horizon[lane];
    store(rises.start[n], start);
    store(rises.rise[n], rise);
    store(rises.from[n], from);
    store(rises.to[n], to);
    store_u32(rises.surface[n], surface);
  };
  unsigned at_roof = 0;
  while (true) {
    const mask8 active = (cells.d < end_m) & cells.on(grid) & (horizon <= highest);
    if (!any(active)) break;
    const CellEnds<f64x8> ends = ends_of(scene, p, cells);
    const f64x8 end = max(cells.d, min(ends.nearest, end_m));
    at_roof = movemask(active & (roof_m <= end));
    if (at_roof != 0) break;
    if (rises.n > Rises::kMost - Rises::kMostOfCells) {
      answer(rises, rows, lanes);
      rises.n = 0;
    }
    const u64x8 at = to_u64(number_of(grid, cells, active));
    const Corners<f64x8> y = corners(grid, at);
    prefetch_ahead(grid, p, cells);
    const mask8 known = active & y.known;
    const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
        __attribute__((always_inline)) {
      const f64x8 start = cut.start - scene.antenna_y_m;
      const auto slope_at = [&](f64x8 d) __attribute__((always_inline)) {
        return (start + cut.rise * d) / d;
      };
      if (any(where & beginning)) {
        const f64x8 first = slope_at(d0);
        // Nothing is under the antenna itself, at 0 or -0.
        const mask8 under = where & beginning & (d0 > 0.0) & (first > horizon);
        if (any(under)) {
          horizon = select(under, first, horizon);
          note(broadcast(-1), f64x8{}, f64x8{}, f64x8{}, u64x8{} + std::uint64_t{kUnderVoid});
        }
        beginning &= ~where;
      }
      // Facing when the antenna is above the triangle's plane: then elevation rises along it.
      const f64x8 last = slope_at(d1);
      const mask8 rising = where & (start < 0.0) & (last > horizon);
      if (!any(rising)) return;
      horizon = select(rising, last, horizon);
      note(start, cut.rise, d0, d1, at * 2 + ones_of(cut.upper));
    };
    visit_triangles(p, cells, y, known, end, triangle);
    beginning |= active & ~y.known;
    move_on(p, ends, active, active & (ends.nearest <= end_m), end, cells);
  }
  if (rises.n > 0) answer(rises, rows, lanes);
  store_cells(lanes, cells);
  return at_roof;
}

}  // namespace obliq::OBLIQ_ISA
