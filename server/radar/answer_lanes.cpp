// First hits on bare ground of rays that lie in eight vertical planes. The rays of a plane come in rising
// order: those that are left lie above all that is nearer, so a triangle has those that lie below its far
// end.
#include "server/radar/answer_lanes.h"

#include "server/radar/cell_lanes.h"

namespace obliq::OBLIQ_ISA {

unsigned answer_rays(const GroundScene& scene, const RayRows& rows, RayLanes& lanes) {
  const LaneGrid& grid = scene.grid;
  const PlaneRates p = plane_rates(scene, lanes);
  const Lanes end_m = load_lanes(lanes.end_m);
  const Lanes roof_m = load_lanes(lanes.roof_m);
  const LaneBits last = LaneBits{} + rows.n;
  const LaneBits first = LaneBits{0, 1, 2, 3, 4, 5, 6, 7} * rows.n;
  Cells cells = cells_of(lanes);
  LaneBits next = load_bits(lanes.next);
  Lanes slope = gather(rows.slope, next);
  unsigned at_roof = 0;
  while (true) {
    const LaneFlags active = (cells.d < end_m) & cells.on(grid) & (next < last);
    if (!any(active)) break;
    const CellEnds ends = cell_ends(scene, p, cells);
    const Lanes end = greatest(cells.d, least(ends.nearest, end_m));
    at_roof = mask_of(active & (roof_m <= end));
    if (at_roof != 0) break;
    const Lanes cell = cells.number(grid, active);
    const LaneBits at = integers_of(cell);
    const Corners y = corners(grid, at);
    const auto triangle = [&](LaneFlags where, const TriangleCut& cut, Lanes d0, Lanes d1)
        __attribute__((always_inline)) {
      const Lanes start = cut.start - scene.antenna_y_m;
      const Lanes h0 = start + cut.rise * d0;
      const Lanes h1 = start + cut.rise * d1;
      while (true) {
        // Behind a void the ground may begin above a ray.
        const LaneFlags under = where & (slope * d0 < h0);
        const LaneFlags hit = where & ~under & (start < 0.0) & (slope * d1 < h1);
        const unsigned taken = mask_of(under | hit);
        if (taken == 0) return;
        const Lanes d = clamp(start / (slope - cut.rise), d0, d1);
        const Lanes range = d * gather(rows.secant, next);
        const unsigned hits = mask_of(hit);
        if (hits != taken)
          scatter(taken & ~hits, lanes.surface, first + next, LaneBits{} + std::uint64_t{kUnderVoid});
        scatter(hits, lanes.slant_range_m, first + next, range);
        scatter(hits, lanes.surface, first + next, at * 2 + ones_of(cut.upper));
        next += ones_of(under | hit);
        slope = gather(rows.slope, next);
      }
    };
    visit_triangles(p, cells, y, active & y.known, end, triangle);
    move_on(p, ends, active, active & (ends.nearest <= end_m), end, cells);
  }
  store_cells(lanes, cells);
  store_bits(lanes.next, next);
  return at_roof;
}

}  // namespace obliq::OBLIQ_ISA
