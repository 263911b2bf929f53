// Plates over bare ground for eight pixels at a time. Along visible ground that is looked at outwards the
// elevation rises without a gap, also from a crest to what is seen behind it, so that a part's share is known
// from its two ends, whatever triangles lie between them.
#include "server/radar/simd/ground/ground_plates.h"

#include "server/radar/simd/ground/grid_walk.h"
#include "server/radar/simd/ground/range_run.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// How far a walk's start may lie from the last place that was looked at, and how often one is looked for:
/// together farther than most plates reach.
constexpr double kStep_cells = 4;
constexpr int kMostSteps = 16;

/// The planes of eight hits, and what each pixel covers of its plane, in slopes.
struct Sights {
  f64x8 d, h, slope, half, low, high;
};

/// A pixel's extent in slope, up / sqrt(X^2 + ahead^2), is the root of the summed squares of what a row and a
/// column change: a square pixel then has the same extent whichever way it is turned to the plane, the one
/// whose even spread has the pixel's own variance.
OBLIQ_INLINE f64x8 half_extent(const PlateField& field, f64x8 dx, f64x8 up, f64x8 dz, f64x8 ground) {
  const f64x8 x = dx * field.cos_bearing - dz * field.sin_bearing;
  const f64x8 ahead = dx * field.sin_bearing + dz * field.cos_bearing;
  const f64x8 along_axis = ahead * field.cos_pitch - up * field.sin_pitch;
  const f64x8 by_row = field.half_height * (field.cos_pitch * ground * ground - up * ahead * field.sin_pitch);
  const f64x8 by_column = field.half_width * (up * x);
  return along_axis * sqrt(by_row * by_row + by_column * by_column) / (ground * ground * ground);
}

/// The triangle that lies under eight profiles at distances d.
struct GroundUnder {
  TriangleCut<f64x8> cut;
  Cells<f64x8> cells;
  mask8 known;
};

OBLIQ_INLINE GroundUnder ground_under(const GroundView& ground, const ProfileRates<f64x8>& p, mask8 where,
                                      f64x8 d) {
  GroundUnder under;
  const f64x8 u = p.start_u + d * p.rate_u;
  const f64x8 v = p.start_v + d * p.rate_v;
  under.cells = {d, floor(u), floor(v)};
  where &= under.cells.on(ground.grid);
  const Corners<f64x8> y = corners(ground.grid, number_of(ground.grid, under.cells, where));
  under.known = where & y.known;
  under.cut = triangle_cut(p, under.cells, y, (u - under.cells.i) + (v - under.cells.j) > 1.0);
  under.cut.start -= ground.antenna_y_m;
  return under;
}

/// Where to walk from: a place nearer than the hit with ground at the pixel's lower edge or below it.
struct Starts {
  Cells<f64x8> cells;
  mask8 found;
};

OBLIQ_INLINE Starts starts_of(const PlateField& field, const ProfileRates<f64x8>& p, const Sights& at,
                              mask8 wanted) {
  const double cell_m = field.ground.grid.cell_m;
  const f64x8 least = max(f64x8{}, at.d - field.reach_m);
  Starts starts{{at.d, f64x8{}, f64x8{}}, mask8{}};
  f64x8 d = at.d;
  mask8 open = wanted;
  for (int step = 0; step <= kMostSteps; ++step) {
    const GroundUnder under = ground_under(field.ground, p, open, d);
    const f64x8 start = under.cut.start;
    const f64x8 rise = under.cut.rise;
    const mask8 here = open & under.known & ((start + rise * d <= at.low * d) | (d <= least));
    starts.cells.d = select(here, d, starts.cells.d);
    starts.cells.i = select(here, under.cells.i, starts.cells.i);
    starts.cells.j = select(here, under.cells.j, starts.cells.j);
    starts.found |= here;
    open &= under.known & ~here;
    if (!any(open)) break;
    // To where the plane comes up to the lower edge, a bit farther in, for the ground is not plane.
    const f64x8 plane = select(rise > at.low, start / (at.low - rise), f64x8{}) - cell_m / 8;
    d = max(least, max(d - kStep_cells * cell_m, min(d - cell_m / 8, plane)));
  }
  return starts;
}

/// The parts of eight plates while they are walked: the current one of each, and those that are complete.
struct Parts {
  GroundPlates& rows;
  const RangeAxis& axis;
  f64x8 bin, end_m;              // the current range bin and its far edge
  f64x8 r, d, sine;              // where the current part begins
  f64x8 at_r, at_sine, cosines;  // up to where incidence is summed up
  f64x8 material, raster_gamma;
  mask8 crowded;

  OBLIQ_INLINE void close(mask8 where, f64x8 to_r, f64x8 to_d, f64x8 to_sine) {
    const unsigned whose = movemask(where & (to_sine > sine));
    if (whose == 0) return;
    const int n = rows.n;
    if (n == GroundPlates::kMost) {
      crowded |= where;
      return;
    }
    rows.whose[n] = whose;
    store(rows.bin[n], bin);
    store(rows.near_m[n], r);
    store(rows.far_m[n], to_r);
    store(rows.near_d_m[n], d);
    store(rows.far_d_m[n], to_d);
    store(rows.near_sine[n], sine);
    store(rows.far_sine[n], to_sine);
    store(rows.cosines[n], cosines);
    store(rows.material[n], material);
    store(rows.raster_gamma[n], raster_gamma);
    ++rows.n;
  }

  OBLIQ_INLINE void open(mask8 where, f64x8 in_bin, f64x8 from_r, f64x8 from_d, f64x8 from_sine) {
    bin = select(where, in_bin, bin);
    const f64x8 edge = axis.edge_m(bin + 1.0);
    end_m = select(where, select(bin < static_cast<double>(axis.n_range), edge, broadcast(__builtin_inf())),
                   end_m);
    r = select(where, from_r, r);
    d = select(where, from_d, d);
    sine = select(where, from_sine, sine);
    at_r = select(where, from_r, at_r);
    at_sine = select(where, from_sine, at_sine);
    cosines = select(where, f64x8{}, cosines);
  }

  OBLIQ_INLINE void add_incidence(mask8 where, f64x8 plane_distance, f64x8 to_r, f64x8 to_sine) {
    const f64x8 cosine = min(broadcast(1), 2.0 * plane_distance / (at_r + to_r));
    cosines = select(where, cosines + (to_sine - at_sine) * cosine, cosines);
    at_r = select(where, to_r, at_r);
    at_sine = select(where, to_sine, at_sine);
  }

  OBLIQ_INLINE f64x8 bin_at(f64x8 range) const {
    const f64x8 inside =
        min(floor((range - axis.r_min_m) / axis.range_spacing_m), broadcast(axis.n_range - 1));
    return select(range < axis.r_min_m, broadcast(-1),
                  select(range >= axis.r_max_m, broadcast(axis.n_range), inside));
  }
};

/// What a table [nz - 1][nx - 1] has of cells.
template <typename T>
OBLIQ_INLINE f64x8 of_cells(const PlateField& field, const T* table, const Cells<f64x8>& cells, mask8 where) {
  const f64x8 number = cells.j * static_cast<double>(field.ground.grid.nx - 1) + cells.i;
  std::uint64_t at[kLanes];
  store(at, to_u64(select(where, number, f64x8{})));
  return lane_by_lane<double, kLanes>([&](int lane) __attribute__((always_inline)) {
    return static_cast<double>(table[at[lane]]);
  });
}

}  // namespace

void ground_plates(const PlateField& field, const PlateRays& rays, int first, unsigned wanted_lanes,
                   GroundPlates& plates) {
  const GroundView& ground = field.ground;
  const f64x8 dx = load(rays.dir_x + first);
  const f64x8 up = load(rays.dir_y + first);
  const f64x8 dz = load(rays.dir_z + first);
  const f64x8 range = load(rays.slant_range_m + first);
  const f64x8 level = sqrt(dx * dx + dz * dz);
  const f64x8 sin_bearing = dx / level;
  const f64x8 cos_bearing = dz / level;
  Sights at;
  at.d = range * level;
  at.h = range * up;
  at.slope = up / level;
  at.half = half_extent(field, dx, up, dz, level);
  at.low = at.slope - at.half;
  at.high = at.slope + at.half;
  store(plates.sin_bearing, sin_bearing);
  store(plates.cos_bearing, cos_bearing);
  store(plates.d_m, at.d);
  store(plates.h_m, at.h);
  store(plates.slope, at.slope);
  store(plates.half_extent, at.half);
  plates.n = 0;

  const ProfileRates<f64x8> p = profile_rates(ground, sin_bearing, cos_bearing);
  const Starts starts = starts_of(field, p, at, mask_from(wanted_lanes) & (level > 0.0));
  const f64x8 end_m = at.d + field.reach_m;
  const f64x8 none{};
  Parts parts{plates, field.axis, none, none, none, none, none, none, none, none, none, none, mask8{}};
  Cells<f64x8> cells = starts.cells;
  f64x8 horizon_d = broadcast(1);
  f64x8 horizon_h = at.low;
  f64x8 unseen{};
  mask8 walking = starts.found;
  mask8 begun{};
  mask8 reached{};
  mask8 falls{};
  f64x8 material{};
  f64x8 raster_gamma{};
  const auto next = [&](mask8 active, const CellEnds<f64x8>& /*ends*/, f64x8& /*to*/)
      __attribute__((always_inline)) {
    return active & walking & ~reached & ~falls & ~parts.crowded &
           (unseen <= static_cast<double>(field.look_cells));
  };
  const auto cell = [&](mask8 active, mask8 known, f64x8 /*number*/, f64x8 /*end*/)
      __attribute__((always_inline)) {
    walking = active & known;
    if (field.material != nullptr) material = of_cells(field, field.material, cells, walking);
    if (field.raster_gamma != nullptr) raster_gamma = of_cells(field, field.raster_gamma, cells, walking);
    unseen += 1.0;
  };
  const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
      __attribute__((always_inline)) {
    const f64x8 start = cut.start - ground.antenna_y_m;
    const f64x8 rise = cut.rise;
    const f64x8 h1 = start + rise * d1;
    const mask8 seen = where & ~reached & (start < 0.0) & ~(h1 * horizon_d < horizon_h * d1);
    if (!any(seen)) return;
    const f64x8 h0 = start + rise * d0;
    const mask8 emerges = seen & (h0 * horizon_d < horizon_h * d0);
    f64x8 from = d0;
    if (any(emerges))
      from = select(emerges, clamp(start * horizon_d / (horizon_h - rise * horizon_d), d0, d1), d0);
    const mask8 last = seen & (h1 >= at.high * d1);
    f64x8 to = d1;
    if (any(last)) to = select(last, clamp(start / (at.high - rise), from, d1), d1);
    const f64x8 from_h = start + rise * from;
    const f64x8 to_h = start + rise * to;
    const f64x8 rate2 = 1.0 + rise * rise;
    const f64x8 along = start * rise;
    falls |= seen & (along + rate2 * from < 0.0);

    // A part ends at a crest behind which another bin is seen, and where the material or what a gamma raster
    // says of it changes.
    const f64x8 from_r2 = from * from + from_h * from_h;
    const mask8 opens = seen & (~begun | (emerges & (from_r2 >= parts.end_m * parts.end_m)) |
                                (material != parts.material) | (raster_gamma != parts.raster_gamma));
    if (any(opens)) {
      const f64x8 horizon_r = sqrt(horizon_d * horizon_d + horizon_h * horizon_h);
      parts.close(opens & begun, horizon_r, horizon_d, horizon_h / horizon_r);
      const f64x8 from_r = sqrt(from_r2);
      parts.open(opens, parts.bin_at(from_r), from_r, from, from_h / from_r);
      parts.material = select(opens, material, parts.material);
      parts.raster_gamma = select(opens, raster_gamma, parts.raster_gamma);
      begun |= opens;
    }
    f64x8 plane_distance{};
    if (field.incidence) {
      const f64x8 slope_x = cut.per_i / ground.grid.cell_m;
      const f64x8 slope_z = cut.per_j / ground.grid.cell_m;
      plane_distance = -start / sqrt(1.0 + slope_x * slope_x + slope_z * slope_z);
    }
    const f64x8 to_r2 = to * to + to_h * to_h;
    mask8 crosses = seen & (to_r2 >= parts.end_m * parts.end_m);
    while (any(crosses)) {
      const f64x8 edge = parts.end_m;
      const f64x8 edge_d = edge_at(rate2, along, -start, broadcast(1), edge, from, to);
      const f64x8 sine = (start + rise * edge_d) / edge;
      if (field.incidence) parts.add_incidence(crosses, plane_distance, edge, sine);
      parts.close(crosses, edge, edge_d, sine);
      parts.open(crosses, parts.bin + 1.0, edge, edge_d, sine);
      crosses &= (to_r2 >= parts.end_m * parts.end_m) & ~parts.crowded;
    }
    if (field.incidence) {
      const f64x8 to_r = sqrt(to_r2);
      parts.add_incidence(seen, plane_distance, to_r, to_h / to_r);
    }
    horizon_d = select(seen, to, horizon_d);
    horizon_h = select(seen, to_h, horizon_h);
    reached |= last;
    unseen = select(seen, f64x8{}, unseen);
  };
  march(ground, p, end_m, cells, next, cell, triangle);
  const f64x8 horizon_r = sqrt(horizon_d * horizon_d + horizon_h * horizon_h);
  parts.close(begun, horizon_r, horizon_d, horizon_h / horizon_r);
  // A walk that ended before the hit met a void.
  const mask8 walked = begun & ~falls & ~parts.crowded & (reached | (horizon_d >= at.d - field.touching_m));
  plates.walked = movemask(walked);
  store(plates.from_m, starts.cells.d);
  store(plates.to_m, cells.d);
}

unsigned plate_samples(const PlateField& field, const PlatePixels& pixels, const GroundPlates& plates,
                       SampleBatch& out) {
  unsigned kept[GroundPlates::kMost];
  const auto share_of = [&](int row) __attribute__((always_inline)) {
    return load(plates.far_sine[row]) - load(plates.near_sine[row]);
  };
  const f64x8 hit_bin = field.axis.bin(load(pixels.slant_range_m));
  f64x8 all{};
  for (int row = 0; row < plates.n; ++row) {
    kept[row] = plates.whose[row] & plates.walked;
    const f64x8 bin = load(plates.bin[row]);
    // The hit's own bin is visible, the ray says so.
    const mask8 asked = (bin >= 0.0) & (bin < static_cast<double>(field.axis.n_range)) & (bin != hit_bin);
    for (unsigned left = kept[row] & movemask(asked); left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      if (pixels.visible[lane][static_cast<int>(plates.bin[row][lane])] == 0) kept[row] &= ~(1u << lane);
    }
    all = select(mask_from(kept[row]), all + share_of(row), all);
  }
  // What only touches a bin's edge would put light into it by rounding alone.
  const f64x8 least = 1e-9 * all;
  f64x8 sum{};
  for (int row = 0; row < plates.n; ++row) {
    const f64x8 share = share_of(row);
    kept[row] &= movemask(share >= least);
    sum = select(mask_from(kept[row]), sum + share, sum);
  }
  const f64x8 scale = load(pixels.solid_angle_sr) / sum;
  const f64x8 sin_bearing = load(plates.sin_bearing);
  const f64x8 cos_bearing = load(plates.cos_bearing);
  for (int row = 0; row < plates.n; ++row) {
    if (kept[row] == 0) continue;
    const f64x8 share = share_of(row);
    const f64x8 d = (load(plates.near_d_m[row]) + load(plates.far_d_m[row])) / 2.0;
    GroundPlates::Row range, solid_angle, sine, x, z, cosine;
    store(range, mean_power_range_m(load(plates.near_m[row]), load(plates.far_m[row])));
    store(solid_angle, share * scale);
    store(sine, (load(plates.near_sine[row]) + load(plates.far_sine[row])) / 2.0);
    store(x, field.ground.antenna_x_m + d * sin_bearing);
    store(z, field.ground.antenna_z_m + d * cos_bearing);
    store(cosine, field.incidence ? load(plates.cosines[row]) / share : load(pixels.cos_incidence));
    for (unsigned left = kept[row]; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      const int n = out.n++;
      out.azimuth_bin[n] = pixels.azimuth_bin[lane];
      out.slant_range_m[n] = range[lane];
      out.solid_angle_sr[n] = solid_angle[lane];
      out.cos_incidence[n] = cosine[lane];
      out.azimuth_offset_rad[n] = pixels.azimuth_offset_rad[lane];
      out.sin_elevation[n] = sine[lane];
      out.x_m[n] = x[lane];
      out.z_m[n] = z[lane];
      out.face[n] = kNoFace;
      out.material[n] = static_cast<std::uint8_t>(plates.material[row][lane]);
      if (field.raster_gamma != nullptr)
        out.raster_gamma[n] = static_cast<float>(plates.raster_gamma[row][lane]);
    }
  }
  return plates.walked & ~movemask(sum > 0.0);
}

}  // namespace obliq::OBLIQ_ISA
