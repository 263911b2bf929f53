// The ground's height at eight crossings of a profile with the mesh's edges at a time. The edges are three
// families of parallel lines: x, z and x + z whole, in cells.
#include "server/radar/simd/highest_ground.h"

#include "server/radar/simd/lanes.h"
#include "server/scene/tolerances.h"

namespace obliq::OBLIQ_ISA {
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
