// ProfileMarch over bare ground for eight planes at a time, to the bit.
#include "server/radar/simd/visible_ranges.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kInfinity = __builtin_inf();

/// Squares of the least and the greatest slant range on straight pieces.
struct Ranges {
  Lanes least2, greatest2;
};

OBLIQ_LANES Ranges ranges_of(LaneFlags where, Lanes d0, Lanes h0, Lanes d1, Lanes h1) {
  const Lanes first2 = d0 * d0 + h0 * h0;
  const Lanes last2 = d1 * d1 + h1 * h1;
  Ranges ranges{least(first2, last2), greatest(first2, last2)};
  const Lanes dd = d1 - d0;
  const Lanes dh = h1 - h0;
  const Lanes along = -(d0 * dd + h0 * dh);
  if (!any(where & (along > 0.0))) return ranges;
  const Lanes length2 = dd * dd + dh * dh;
  const Lanes cross = d0 * dh - h0 * dd;
  const LaneFlags foot = (along > 0.0) & (along < length2);
  ranges.least2 = select(foot, least(ranges.least2, cross * cross / length2), ranges.least2);
  return ranges;
}

/// RangeRun, eight of them.
struct Runs {
  Lanes least2, greatest2;

  OBLIQ_LANES void add(LaneFlags where, const Ranges& ranges) {
    least2 = select(where, least(least2, ranges.least2), least2);
    greatest2 = select(where, greatest(greatest2, ranges.greatest2), greatest2);
  }

  /// Marks the bins of the lanes' runs and empties them.
  OBLIQ_LANES void close(LaneFlags where, const ProfileBins& bins, std::uint8_t* const* marks) {
    where &= greatest2 >= 0.0;
    const unsigned mask = mask_of(where);
    if (mask == 0) return;
    const Lanes low = sqrt_of(least2);
    const Lanes high = sqrt_of(greatest2);
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
    least2 = select(where, all_lanes(kInfinity), least2);
    greatest2 = select(where, all_lanes(-1), greatest2);
  }
};

/// Member `part` of the lanes' states.
#define OBLIQ_LOAD(part)                                                                                     \
  Lanes {                                                                                                    \
    lanes.state[0].part, lanes.state[1].part, lanes.state[2].part, lanes.state[3].part, lanes.state[4].part, \
        lanes.state[5].part, lanes.state[6].part, lanes.state[7].part                                        \
  }

}  // namespace

unsigned march_profiles(const GroundScene& scene, const ProfileBins& bins, ProfileLanes& lanes) {
  const LaneGrid& grid = scene.grid;
  const PlaneRates p = plane_rates(scene, lanes);
  const Lanes end_m = load_lanes(lanes.end_m);
  const Lanes roof_m = load_lanes(lanes.roof_m);
  Cells cells = cells_of(lanes);
  Lanes horizon_d = OBLIQ_LOAD(horizon_d_m);
  Lanes horizon_h = OBLIQ_LOAD(horizon_h_m);
  Lanes last_h = OBLIQ_LOAD(last_h_m);
  Lanes joined = OBLIQ_LOAD(joined);
  Runs visible{OBLIQ_LOAD(visible_least2), OBLIQ_LOAD(visible_greatest2)};
  Runs present{OBLIQ_LOAD(present_least2), OBLIQ_LOAD(present_greatest2)};
  unsigned at_roof = 0;
  while (true) {
    const LaneFlags active = (cells.d < end_m) & cells.on(grid);
    if (!any(active)) break;
    const CellEnds ends = cell_ends(scene, p, cells);
    const Lanes end = greatest(cells.d, least(ends.nearest, end_m));
    at_roof = mask_of(active & (roof_m <= end));
    if (at_roof != 0) break;

    const Corners y = corners(grid, integers_of(cells.number(grid, active)));
    prefetch_ahead(grid, p, cells);
    const LaneFlags known = active & y.known;
    if (const LaneFlags gap = active & ~known; any(gap)) {
      visible.close(gap, bins, lanes.visible);
      present.close(gap, bins, lanes.present);
      joined = select(gap, Lanes{}, joined);
    }

    const auto triangle = [&](LaneFlags where, const TriangleCut& cut, Lanes d0, Lanes d1)
        __attribute__((always_inline)) {
      const Lanes h0 = cut.start + cut.rise * d0 - scene.antenna_y_m;
      const Lanes h1 = cut.start + cut.rise * d1 - scene.antenna_y_m;
      const Ranges ranges = ranges_of(where, d0, h0, d1, h1);
      present.add(where, ranges);
      const LaneFlags hides0 = h0 * horizon_d < horizon_h * d0;
      const LaneFlags hides1 = h1 * horizon_d < horizon_h * d1;
      const LaneFlags rises = where & ~hides1 & (h1 * d0 > h0 * d1);
      const LaneFlags emerges = rises & hides0;
      const LaneFlags unseen = where & ~rises;  // hidden at its far end, or seen at its near edge only
      visible.close(unseen | emerges, bins, lanes.visible);
      visible.add(rises & ~emerges, ranges);
      if (any(emerges)) {
        const Lanes slope = (h1 - h0) / (d1 - d0);
        const Lanes from = clamp((h0 - slope * d0) / (horizon_h / horizon_d - slope), d0, d1);
        visible.add(emerges, ranges_of(emerges, from, h0 + slope * (from - d0), d1, h1));
      }
      const LaneFlags to_near = unseen & ~(hides1 & hides0) & (d0 > 0.0);
      const LaneFlags to_far = rises & (d1 > 0.0);
      horizon_d = select(to_far, d1, select(to_near, d0, horizon_d));
      horizon_h = select(to_far, h1, select(to_near, h0, horizon_h));
      last_h = select(where, h1, last_h);
      joined = select(where, all_lanes(1), joined);
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
