// ProfileMarch over bare ground for eight planes at a time, to the bit.
#include "server/radar/simd/visible_ranges.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kInfinity = __builtin_inf();

/// Squares of the least and the greatest slant range on straight pieces.
struct Ranges {
  f64x8 least2, greatest2;
};

OBLIQ_INLINE Ranges ranges_of(mask8 where, f64x8 d0, f64x8 h0, f64x8 d1, f64x8 h1) {
  const f64x8 first2 = d0 * d0 + h0 * h0;
  const f64x8 last2 = d1 * d1 + h1 * h1;
  Ranges ranges{min(first2, last2), max(first2, last2)};
  const f64x8 dd = d1 - d0;
  const f64x8 dh = h1 - h0;
  const f64x8 along = -(d0 * dd + h0 * dh);
  if (!any(where & (along > 0.0))) return ranges;
  const f64x8 length2 = dd * dd + dh * dh;
  const f64x8 cross = d0 * dh - h0 * dd;
  const mask8 foot = (along > 0.0) & (along < length2);
  ranges.least2 = select(foot, min(ranges.least2, cross * cross / length2), ranges.least2);
  return ranges;
}

/// RangeRun, eight of them.
struct Runs {
  f64x8 least2, greatest2;

  OBLIQ_INLINE void add(mask8 where, const Ranges& ranges) {
    least2 = select(where, min(least2, ranges.least2), least2);
    greatest2 = select(where, max(greatest2, ranges.greatest2), greatest2);
  }

  /// Marks the bins of the lanes' runs and empties them.
  OBLIQ_INLINE void close(mask8 where, const ProfileBins& bins, std::uint8_t* const* marks) {
    where &= greatest2 >= 0.0;
    const unsigned mask = movemask(where);
    if (mask == 0) return;
    const f64x8 low = sqrt(least2);
    const f64x8 high = sqrt(greatest2);
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((mask >> lane & 1) == 0 || high[lane] < bins.r_min_m || low[lane] >= bins.r_max_m) continue;
      const auto bin_of = [&](double r) __attribute__((always_inline)) {
        const int bin = static_cast<int>((r - bins.r_min_m) / bins.range_spacing_m);
        return bin < bins.n_range ? bin : bins.n_range - 1;
      };
      const int last = high[lane] >= bins.r_max_m ? bins.n_range - 1 : bin_of(high[lane]);
      for (int bin = low[lane] < bins.r_min_m ? 0 : bin_of(low[lane]); bin <= last; ++bin)
        marks[lane][bin] = 1;
    }
    least2 = select(where, broadcast(kInfinity), least2);
    greatest2 = select(where, broadcast(-1), greatest2);
  }
};

/// Member `part` of the lanes' states.
#define OBLIQ_LOAD(part)                                                                                     \
  f64x8 {                                                                                                    \
    lanes.state[0].part, lanes.state[1].part, lanes.state[2].part, lanes.state[3].part, lanes.state[4].part, \
        lanes.state[5].part, lanes.state[6].part, lanes.state[7].part                                        \
  }

}  // namespace

unsigned march_profiles(const GroundScene& scene, const ProfileBins& bins, ProfileLanes& lanes) {
  const LaneGrid& grid = scene.grid;
  const PlaneRates p = plane_rates(scene, lanes);
  const f64x8 end_m = load(lanes.end_m);
  const f64x8 roof_m = load(lanes.roof_m);
  Cells cells = cells_of(lanes);
  f64x8 horizon_d = OBLIQ_LOAD(horizon_d_m);
  f64x8 horizon_h = OBLIQ_LOAD(horizon_h_m);
  f64x8 last_h = OBLIQ_LOAD(last_h_m);
  f64x8 joined = OBLIQ_LOAD(joined);
  Runs visible{OBLIQ_LOAD(visible_least2), OBLIQ_LOAD(visible_greatest2)};
  Runs present{OBLIQ_LOAD(present_least2), OBLIQ_LOAD(present_greatest2)};
  unsigned at_roof = 0;
  while (true) {
    const mask8 active = (cells.d < end_m) & cells.on(grid);
    if (!any(active)) break;
    const CellEnds ends = cell_ends(scene, p, cells);
    const f64x8 end = max(cells.d, min(ends.nearest, end_m));
    at_roof = movemask(active & (roof_m <= end));
    if (at_roof != 0) break;

    const Corners y = corners(grid, to_u64(cells.number(grid, active)));
    prefetch_ahead(grid, p, cells);
    const mask8 known = active & y.known;
    if (const mask8 gap = active & ~known; any(gap)) {
      visible.close(gap, bins, lanes.visible);
      present.close(gap, bins, lanes.present);
      joined = select(gap, f64x8{}, joined);
    }

    const auto triangle = [&](mask8 where, const TriangleCut& cut, f64x8 d0, f64x8 d1)
        __attribute__((always_inline)) {
      const f64x8 h0 = cut.start + cut.rise * d0 - scene.antenna_y_m;
      const f64x8 h1 = cut.start + cut.rise * d1 - scene.antenna_y_m;
      const Ranges ranges = ranges_of(where, d0, h0, d1, h1);
      present.add(where, ranges);
      const mask8 hides0 = h0 * horizon_d < horizon_h * d0;
      const mask8 hides1 = h1 * horizon_d < horizon_h * d1;
      const mask8 rises = where & ~hides1 & (h1 * d0 > h0 * d1);
      const mask8 emerges = rises & hides0;
      const mask8 unseen = where & ~rises;  // hidden at its far end, or seen at its near edge only
      visible.close(unseen | emerges, bins, lanes.visible);
      visible.add(rises & ~emerges, ranges);
      if (any(emerges)) {
        const f64x8 slope = (h1 - h0) / (d1 - d0);
        const f64x8 from = clamp((h0 - slope * d0) / (horizon_h / horizon_d - slope), d0, d1);
        visible.add(emerges, ranges_of(emerges, from, h0 + slope * (from - d0), d1, h1));
      }
      const mask8 to_near = unseen & ~(hides1 & hides0) & (d0 > 0.0);
      const mask8 to_far = rises & (d1 > 0.0);
      horizon_d = select(to_far, d1, select(to_near, d0, horizon_d));
      horizon_h = select(to_far, h1, select(to_near, h0, horizon_h));
      last_h = select(where, h1, last_h);
      joined = select(where, broadcast(1), joined);
    };
    visit_triangles(p, cells, y, known, end, triangle);
    move_on(p, ends, active, active & (ends.nearest <= end_m), end, cells);
  }
  store_cells(lanes, cells);
  for (int lane = 0; lane < kLanes; ++lane)
    lanes.state[lane] = {
        horizon_d[lane],      horizon_h[lane],         visible.least2[lane], visible.greatest2[lane],
        present.least2[lane], present.greatest2[lane], last_h[lane],         joined[lane]};
  return at_roof;
}

}  // namespace obliq::OBLIQ_ISA
