// ProfileMarch over bare ground for eight planes at a time, to the bit.
#include "server/radar/profile_lanes.h"

#include "server/radar/lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kInfinity = __builtin_inf();

/// RangeRun, eight of them.
struct Runs {
  Lanes least2, greatest2;

  OBLIQ_LANES void add(LaneFlags where, Lanes d0, Lanes h0, Lanes d1, Lanes h1) {
    const Lanes first2 = d0 * d0 + h0 * h0;
    const Lanes last2 = d1 * d1 + h1 * h1;
    const Lanes dd = d1 - d0;
    const Lanes dh = h1 - h0;
    const Lanes along = -(d0 * dd + h0 * dh);
    const Lanes length2 = dd * dd + dh * dh;
    const Lanes cross = d0 * dh - h0 * dd;
    Lanes low = least(first2, last2);
    const LaneFlags foot = where & (along > 0.0) & (along < length2);
    if (any(foot)) low = select(foot, least(low, cross * cross / length2), low);
    least2 = select(where, least(least2, low), least2);
    greatest2 = select(where, greatest(greatest2, greatest(first2, last2)), greatest2);
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
  const Lanes sin = load_lanes(lanes.sin_bearing);
  const Lanes cos = load_lanes(lanes.cos_bearing);
  const Lanes per_x = select(sin != 0.0, 1.0 / sin, all_lanes(kInfinity));
  const Lanes per_z = select(cos != 0.0, 1.0 / cos, all_lanes(kInfinity));
  const Lanes rate_u = sin / grid.cell_m;
  const Lanes rate_v = cos / grid.cell_m;
  const Lanes rate = rate_u + rate_v;
  const Lanes ahead_i = select(sin > 0.0, all_lanes(1), Lanes{});
  const Lanes ahead_j = select(cos > 0.0, all_lanes(1), Lanes{});
  const Lanes end_m = load_lanes(lanes.end_m);
  const Lanes roof_m = load_lanes(lanes.roof_m);
  const double start_u = (scene.antenna_x_m - grid.x0_m) / grid.cell_m;
  const double start_v = (scene.antenna_z_m - grid.z0_m) / grid.cell_m;
  Lanes d = load_lanes(lanes.d_m);
  Lanes i = load_lanes(lanes.i);
  Lanes j = load_lanes(lanes.j);
  Lanes missing = load_lanes(lanes.missing_m2);
  Lanes horizon_d = OBLIQ_LOAD(horizon_d_m);
  Lanes horizon_h = OBLIQ_LOAD(horizon_h_m);
  Lanes last_h = OBLIQ_LOAD(last_h_m);
  Lanes joined = OBLIQ_LOAD(joined);
  Runs visible{OBLIQ_LOAD(visible_least2), OBLIQ_LOAD(visible_greatest2)};
  Runs present{OBLIQ_LOAD(present_least2), OBLIQ_LOAD(present_greatest2)};
  unsigned at_roof = 0;
  while (true) {
    const LaneFlags active = (d < end_m) & (i >= 0.0) & (j >= 0.0) & (i < static_cast<double>(grid.nx - 1)) &
                             (j < static_cast<double>(grid.nz - 1));
    if (!any(active)) break;
    const Lanes to_x =
        select(sin != 0.0, (grid.x0_m + (i + ahead_i) * grid.cell_m - scene.antenna_x_m) * per_x,
               all_lanes(kInfinity));
    const Lanes to_z =
        select(cos != 0.0, (grid.z0_m + (j + ahead_j) * grid.cell_m - scene.antenna_z_m) * per_z,
               all_lanes(kInfinity));
    const Lanes cell_end = least(to_x, to_z);
    const Lanes end = greatest(d, least(cell_end, end_m));
    at_roof = mask_of(active & (roof_m <= end));
    if (at_roof != 0) break;

    const LaneBits at = integers_of(select(active, j * static_cast<double>(grid.nx) + i, Lanes{}));
    const LaneBits above = at + static_cast<std::uint64_t>(grid.nx);
    const Lanes y00 = gather(grid.y_m, at);
    const Lanes y10 = gather(grid.y_m, at + 1);
    const Lanes y01 = gather(grid.y_m, above);
    const Lanes y11 = gather(grid.y_m, above + 1);
    const Lanes all_four = (y00 + y10) + (y01 + y11);
    const LaneFlags known = active & (all_four == all_four);
    if (const LaneFlags gap = active & ~known; any(gap)) {
      visible.close(gap, bins, lanes.visible);
      present.close(gap, bins, lanes.present);
      joined = select(gap, Lanes{}, joined);
      const Lanes a = clamp(d, all_lanes(bins.near_m), all_lanes(bins.far_m));
      const Lanes b = clamp(end, all_lanes(bins.near_m), all_lanes(bins.far_m));
      missing = select(gap, missing + 0.5 * bins.width_rad * (b - a) * (b + a), missing);
    }

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
      const Lanes per_i = select(upper, y11 - y01, y10 - y00);
      const Lanes per_j = select(upper, y11 - y10, y01 - y00);
      const Lanes start =
          select(upper, y11 + per_i * (s - 1.0) + per_j * (t - 1.0), y00 + per_i * s + per_j * t);
      const Lanes rise = per_i * rate_u + per_j * rate_v;
      const Lanes h0 = start + rise * d0 - scene.antenna_y_m;
      const Lanes h1 = start + rise * d1 - scene.antenna_y_m;
      present.add(where, d0, h0, d1, h1);
      const LaneFlags hides0 = h0 * horizon_d < horizon_h * d0;
      const LaneFlags hides1 = h1 * horizon_d < horizon_h * d1;
      const LaneFlags rises = where & ~hides1 & (h1 * d0 > h0 * d1);
      const LaneFlags emerges = rises & hides0;
      const LaneFlags unseen = where & ~rises;  // hidden at its far end, or seen at its near edge only
      visible.close(unseen | emerges, bins, lanes.visible);
      Lanes from_d = d0;
      Lanes from_h = h0;
      if (any(emerges)) {
        const Lanes slope = (h1 - h0) / (d1 - d0);
        const Lanes out = clamp((h0 - slope * d0) / (horizon_h / horizon_d - slope), d0, d1);
        from_d = select(emerges, out, d0);
        from_h = select(emerges, h0 + slope * (out - d0), h0);
      }
      visible.add(rises, from_d, from_h, d1, h1);
      const LaneFlags to_near = unseen & ~(hides1 & hides0) & (d0 > 0.0);
      const LaneFlags to_far = rises & (d1 > 0.0);
      horizon_d = select(to_far, d1, select(to_near, d0, horizon_d));
      horizon_h = select(to_far, h1, select(to_near, h0, horizon_h));
      last_h = select(where, h1, last_h);
      joined = select(where, all_lanes(1), joined);
    };
    const LaneFlags two = known & both;
    triangle(known, select(both, sum0, sum0 + sum1) > select(both, sum1, all_lanes(2)), d,
             select(both, diagonal, end));
    if (any(two)) triangle(two, sum0 < sum1, diagonal, end);

    const LaneFlags leaves = active & (cell_end <= end_m);
    i = select(leaves & (to_x < to_z), i + (2.0 * ahead_i - 1.0), i);
    j = select(leaves & ~(to_x < to_z), j + (2.0 * ahead_j - 1.0), j);
    d = select(active, end, d);
  }
  store_lanes(lanes.d_m, d);
  store_lanes(lanes.i, i);
  store_lanes(lanes.j, j);
  store_lanes(lanes.missing_m2, missing);
  for (int lane = 0; lane < kLanes; ++lane)
    lanes.state[lane] = {
        horizon_d[lane],      horizon_h[lane],         visible.least2[lane], visible.greatest2[lane],
        present.least2[lane], present.greatest2[lane], last_h[lane],         joined[lane]};
  return at_roof;
}

}  // namespace obliq::OBLIQ_ISA
