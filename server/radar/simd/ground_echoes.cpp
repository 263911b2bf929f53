// From visible segments of ground to the power of each range bin, eight profiles at a time: cut at the edges
// of bins, cross section, radar equation. Nothing in between goes to memory.
#include "server/radar/simd/ground_echoes.h"

#include "server/radar/simd/range_run.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// The range bin that each profile is in.
struct Running {
  f64x8 bin, distance, power, material;
};

OBLIQ_INLINE void put(unsigned ended, const Running& now, GroundEchoes& out) {
  const int n = out.n;
  const u64x8 profile{0, 1, 2, 3, 4, 5, 6, 7};
  const f64x8 at = to_doubles(to_u64(select(mask_from(ended), now.bin, f64x8{})) * 8 + profile);
  store_u32(out.at + n, to_u64(compress(ended, at)));
  store(out.distance_m + n, compress(ended, now.distance));
  store(out.power_w + n, compress(ended, now.power));
  store_u32(out.material + n, to_u64(compress(ended, now.material)));
  out.n = n + __builtin_popcount(ended);
}

/// Materials of the cells of the profiles in `seen`.
OBLIQ_INLINE f64x8 materials_of(const GroundCut& cut, unsigned seen, f64x8 cells) {
  f64x8 material{};
  const u64x8 cell = to_u64(cells);
  const auto nx = static_cast<std::uint64_t>(cut.nx);
  for (int lane = 0; lane < kLanes; ++lane)
    if ((seen >> lane & 1) != 0)
      material[lane] = static_cast<double>(cut.material[cell[lane] / nx * (nx - 1) + cell[lane] % nx]);
  return material;
}

/// Straight parts of profiles whose range rises or falls all along.
struct Parts {
  f64x8 start, rise;  // h = start + rise d
  f64x8 from, to;
  f64x8 gain;  // width x factor, and gamma where that is a constant
  f64x8 material, plane_distance;
};

/// Adds the parts of the profiles in `wanted`. False: the list is full; those that are not done are in
/// `wanted`, from parts.from on.
OBLIQ_INLINE bool add(const GroundCut& cut, Parts& parts, mask8& wanted, Running& now, GroundEchoes& out) {
  const RangeAxis& axis = cut.axis;
  const double bins_per_m = 1 / axis.range_spacing_m;
  const double n_range = axis.n_range;
  const f64x8 start = parts.start;
  const f64x8 rise = parts.rise;
  const f64x8 from_h = start + parts.from * rise;
  const f64x8 to_h = start + parts.to * rise;
  const f64x8 from_r = sqrt(parts.from * parts.from + from_h * from_h);
  const f64x8 to_r = sqrt(parts.to * parts.to + to_h * to_h);
  const f64x8 nearest = min(from_r, to_r);
  const f64x8 farthest = max(from_r, to_r);
  wanted &= ~((farthest < axis.r_min_m) | (nearest >= axis.r_max_m));
  if (!any(wanted)) return true;
  const f64x8 rate2 = 1.0 + rise * rise;
  const f64x8 along = start * rise;
  const f64x8 first_bin =
      select(nearest < axis.r_min_m, broadcast(-1), floor((nearest - axis.r_min_m) * bins_per_m));
  const f64x8 last_bin =
      select(farthest >= axis.r_max_m, broadcast(n_range), floor((farthest - axis.r_min_m) * bins_per_m));
  const f64x8 cuts = select(wanted, last_bin - first_bin, f64x8{});
  const mask8 outwards = to_r > from_r;
  const f64x8 sign = select(outwards, broadcast(1), broadcast(-1));
  const u64x8 profile{0, 1, 2, 3, 4, 5, 6, 7};
  f64x8 d0 = parts.from;
  f64x8 r0 = from_r;
  for (double k = 1; any(wanted); ++k) {
    if (out.n > GroundEchoes::kMost - kLanes) {
      parts.from = d0;
      return false;
    }
    const mask8 at_end = cuts < k;
    f64x8 d1 = parts.to;
    f64x8 r1 = to_r;
    f64x8 bin = first_bin;
    if (k > 1 || movemask(wanted & ~at_end) != 0) {
      const f64x8 edge_index = select(outwards, first_bin + k, last_bin - k + 1.0);
      const f64x8 edge = axis.edge_m(edge_index);
      d1 = select(at_end, parts.to, edge_at(rate2, along, -start, sign, edge, d0, parts.to));
      r1 = select(at_end, to_r, edge);
      bin = select(at_end, select(outwards, last_bin, first_bin),
                   select(outwards, edge_index - 1.0, edge_index));
    }
    // Solid angle of a strip one radian wide: part_of (range_run.h). The mean of 1 / r^2 over it:
    // mean_power_range_m.
    const f64x8 h0 = start + d0 * rise;
    const f64x8 h1 = start + d1 * rise;
    const f64x8 cross = -start * (d1 - d0);
    const f64x8 r01 = r0 * r1;
    const f64x8 turned = r01 + (d0 * d1 + h0 * h1);
    const f64x8 lit = cross * (d0 * r1 + d1 * r0);
    const f64x8 third = (r0 * r0 + r01 + r1 * r1) * (1.0 / 3);
    const mask8 in_swath = wanted & (lit > 0.0) & (bin >= 0.0) & (bin < n_range) & (r01 > kNearest2_m2);
    const unsigned kept = movemask(in_swath);
    if (kept != 0) {
      f64x8 gain = parts.gain;
      if (cut.echo.any_lobes) {
        const f64x8 sec2 = r01 * r01 / third / (parts.plane_distance * parts.plane_distance);
        gain *= cross_section_of_area(cut.echo, to_u64(parts.material), max(sec2, broadcast(1)));
      }
      f64x8 power = cut.echo.range_normalisation ? gain * lit * r01 / (third * turned)
                                                 : gain * lit * third / (r01 * r01 * r01 * turned);
      if (cut.kept != nullptr)
        power *= gather(cut.kept, to_u64(select(in_swath, bin, f64x8{})) * 8 + profile);
      const mask8 has = in_swath & (power > 0.0);
      const mask8 same = has & (bin == now.bin);
      const mask8 fresh = has & ~same;
      if (const unsigned ended = movemask(fresh & (now.bin >= 0.0)); ended != 0) put(ended, now, out);
      now.power = select(same, now.power + power, select(fresh, power, now.power));
      now.bin = select(fresh, bin, now.bin);
      now.distance = select(fresh, (d0 + d1) * 0.5, now.distance);
      now.material = select(fresh, parts.material, now.material);
    }
    d0 = d1;
    r0 = r1;
    wanted &= ~at_end;
  }
  return true;
}

}  // namespace

int ground_echoes(const GroundCut& cut, VisibleSegments& segments, int first, GroundEchoes& out) {
  Running now{load(out.bin_now), load(out.distance_now_m), load(out.power_now_w), load(out.material_now)};
  bool room = true;
  for (; room && first < segments.n; ++first) {
    Parts parts;
    parts.start = load(segments.start_m[first]);
    parts.rise = load(segments.rise[first]);
    parts.plane_distance = load(segments.plane_distance_m[first]);
    parts.material = cut.material == nullptr
                         ? f64x8{}
                         : materials_of(cut, segments.seen[first], load(segments.cell[first]));
    parts.gain = load(segments.width_rad[first]) * cut.echo.factor;
    if (!cut.echo.any_lobes) parts.gain *= gather(cut.echo.gamma, to_u64(parts.material));
    parts.from = load(segments.from_m[first]);
    parts.to = load(segments.to_m[first]);
    // Range falls and rises again where the foot of the perpendicular from the antenna lies on a segment.
    mask8 wanted = mask_from(segments.seen[first]);
    const f64x8 rate2 = 1.0 + parts.rise * parts.rise;
    const f64x8 along = parts.start * parts.rise;
    const mask8 turns = wanted & (along + rate2 * parts.from < 0.0) & (along + rate2 * parts.to > 0.0);
    mask8 left = wanted;
    if (any(turns)) {
      const f64x8 end = parts.to;
      const f64x8 turn = clamp(-along / rate2, parts.from, parts.to);
      parts.to = select(turns, turn, end);
      room = add(cut, parts, wanted, now, out);
      left = wanted | turns;
      parts.to = end;
      if (room) {
        parts.from = turn;
        left = wanted = turns;
        room = add(cut, parts, wanted, now, out);
        if (!room) left = wanted;
      }
    } else {
      room = add(cut, parts, wanted, now, out);
      left = wanted;
    }
    if (!room) {
      store(segments.from_m[first], parts.from);
      segments.seen[first] = movemask(left);
      --first;
    }
  }
  store(out.bin_now, now.bin);
  store(out.distance_now_m, now.distance);
  store(out.power_now_w, now.power);
  store(out.material_now, now.material);
  return first;
}

}  // namespace obliq::OBLIQ_ISA
