// From visible segments of ground to the light of each range bin, sixteen profiles at a time: cut at the
// edges of bins, cross section, radar equation. Nothing in between goes to memory.
#include "server/radar/simd/ground_echoes.h"

#include "server/radar/simd/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// The range bin that each profile is in.
struct Running {
  f32x16 bin, distance, light, material, sine;
};

template <bool kSines>
OBLIQ_INLINE void put(unsigned ended, const Running& now, GroundEchoes& out) {
  int n = out.n;
#if defined(__AVX512F__)
  const auto m = static_cast<__mmask16>(ended);
  const auto profile = lane_numbers<std::int32_t, kFloatLanes>();
  const auto put_words = [&](void* to, __m512i words) __attribute__((always_inline)) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(m, words));
  };
  put_words(out.at + n, __builtin_bit_cast(__m512i, truncated(now.bin) * GroundEchoes::kRuns + profile));
  put_words(out.distance_m + n, __builtin_bit_cast(__m512i, now.distance));
  put_words(out.light + n, __builtin_bit_cast(__m512i, now.light));
  put_words(out.material + n, __builtin_bit_cast(__m512i, truncated(now.material)));
  if constexpr (kSines) put_words(out.sine + n, __builtin_bit_cast(__m512i, now.sine));
  n += __builtin_popcount(ended);
#else
  for (; ended != 0; ended &= ended - 1) {
    const int lane = __builtin_ctz(ended);
    out.at[n] =
        static_cast<std::uint32_t>(now.bin[lane]) * GroundEchoes::kRuns + static_cast<std::uint32_t>(lane);
    out.distance_m[n] = now.distance[lane];
    out.light[n] = now.light[lane];
    if constexpr (kSines) out.sine[n] = now.sine[lane];
    out.material[n++] = static_cast<std::uint32_t>(now.material[lane]);
  }
#endif
  out.n = n;
}

OBLIQ_INLINE f32x16 as_floats(f64x8 first, f64x8 second) {
  return joined(converted<float>(first), converted<float>(second));
}
OBLIQ_INLINE f64x8 first_half(f32x16 x) { return converted<double>(low_half(x)); }
OBLIQ_INLINE f64x8 second_half(f32x16 x) { return converted<double>(high_half(x)); }

/// One row of eight segments in doubles, or none.
struct Row {
  unsigned seen = 0;
  f64x8 start{}, rise{}, from{}, length{}, height{}, width{}, plane_distance{};

  OBLIQ_INLINE explicit Row(const SegmentRows& rows) {
    if (rows.first >= rows.end) return;
    const VisibleSegments& segments = *rows.segments;
    const int row = rows.first;
    seen = segments.seen[row];
    start = load(segments.start_m[row]);
    rise = load(segments.rise[row]);
    from = load(segments.from_m[row]);
    length = load(segments.to_m[row]) - from;
    height = start + from * rise;
    width = load(segments.width_rad[row]);
    plane_distance = load(segments.plane_distance_m[row]);
  }
};

/// Materials of the cells of a row's segments; 0 where there are none.
OBLIQ_INLINE f32x8 materials_of(const GroundCut& cut, const SegmentRows& rows) {
  if (rows.first >= rows.end) return f32x8{};
  const VisibleSegments& segments = *rows.segments;
  const int row = rows.first;
  const auto nx = static_cast<std::uint64_t>(cut.nx);
  return lane_by_lane<float, kLanes>([&](int lane) {
    if ((segments.seen[row] >> lane & 1) == 0) return 0.0F;
    const auto cell = static_cast<std::uint64_t>(segments.cell[row][lane]);
    return static_cast<float>(cut.material[cell / nx * (nx - 1) + cell % nx]);
  });
}

/// Straight segments: (d, h) = (from + t, height + rise t), t from `at` to `end`.
struct Parts {
  f32x16 from, height, rise, facing;  // facing: d rise - h, the same all along
  f32x16 at, end;
  f32x16 gain;  // width, and gamma where that is a constant
  f32x16 material, plane_distance;
};

/// ScatteringTable's cross section by area, with lobes.
OBLIQ_INLINE f32x16 cross_section_of_area(const EchoTable& table, f32x16 material, f32x16 sec2) {
  return as_floats(cross_section_of_area(table, to_u64(first_half(material)), first_half(sec2)),
                   cross_section_of_area(table, to_u64(second_half(material)), second_half(sec2)));
}

/// Adds the parts of the profiles in `wanted`, whose range rises or falls all along. False: the list is full;
/// those that are not done are in `wanted`, from parts.at on.
template <bool kSines>
OBLIQ_INLINE bool add(const GroundCut& cut, Parts& parts, mask16& wanted, Running& now, GroundEchoes& out) {
  const auto r_min = static_cast<float>(cut.axis.r_min_m);
  const auto spacing = static_cast<float>(cut.axis.range_spacing_m);
  const float bins_per_m = 1 / spacing;
  const auto n_range = static_cast<float>(cut.axis.n_range);
  // An edge like the others: what is nearer must not depend on where the swath ends.
  const float r_max = r_min + n_range * spacing;
  const f32x16 rate2 = 1.0F + parts.rise * parts.rise;
  const f32x16 first_d = parts.from + parts.at;
  const f32x16 first_h = parts.height + parts.rise * parts.at;
  const f32x16 last_d = parts.from + parts.end;
  const f32x16 last_h = parts.height + parts.rise * parts.end;
  const f32x16 first_r = sqrt(first_d * first_d + first_h * first_h);
  const f32x16 last_r = sqrt(last_d * last_d + last_h * last_h);
  const f32x16 nearest = min(first_r, last_r);
  const f32x16 farthest = max(first_r, last_r);
  wanted &= ~((farthest < r_min) | (nearest >= r_max));
  if (!any(wanted)) return true;
  const auto bin_of = [&](f32x16 r) __attribute__((always_inline)) {
    const f32x16 at = clamp((r - r_min) * bins_per_m, all_lanes(-1.0F), all_lanes(n_range));
    return floats_of(truncated(at + 1.0F)) - 1.0F;
  };
  const f32x16 first_bin = bin_of(nearest);
  const f32x16 last_bin = bin_of(farthest);
  const f32x16 cuts = select(wanted, last_bin - first_bin, f32x16{});
  const mask16 outwards = last_r > first_r;
  const f32x16 sign = select(outwards, all_lanes(1.0F), all_lanes(-1.0F));
  // Range squared grows by t (2 along + rate2 t) from where the part begins.
  const f32x16 along = first_d + parts.rise * first_h;
  const f32x16 along2 = along * along;
  f32x16 t0{};
  f32x16 d0 = first_d;
  f32x16 h0 = first_h;
  f32x16 r0 = first_r;
  const f32x16 length = parts.end - parts.at;
  for (float k = 1; any(wanted); ++k) {
    if (out.n > GroundEchoes::kMost - GroundEchoes::kSpare) {
      parts.at += t0;
      return false;
    }
    const mask16 at_end = cuts < k;
    f32x16 t1 = length;
    f32x16 r1 = last_r;
    f32x16 bin = first_bin;
    if (k > 1 || any(wanted & ~at_end)) {
      const f32x16 edge_index = select(outwards, first_bin + k, last_bin - k + 1.0F);
      const f32x16 edge = r_min + edge_index * spacing;
      const f32x16 grown = (edge - first_r) * (edge + first_r);
      const f32x16 root = sqrt(max(along2 + rate2 * grown, f32x16{}));
      const f32x16 at_edge = clamp(grown / (along + sign * root), t0, length);
      t1 = select(at_end, length, at_edge);
      r1 = select(at_end, last_r, edge);
      bin = select(at_end, select(outwards, last_bin, first_bin),
                   select(outwards, edge_index - 1.0F, edge_index));
    }
    // Solid angle of a strip one radian wide: part_of (range_run.h). The mean of 1 / r^2 over it:
    // mean_power_range_m.
    const f32x16 d1 = first_d + t1;
    const f32x16 h1 = first_h + parts.rise * t1;
    const f32x16 r01 = r0 * r1;
    const f32x16 turned = r01 + (d0 * d1 + h0 * h1);
    const f32x16 lit = parts.facing * (t1 - t0) * (d0 * r1 + d1 * r0);
    const f32x16 third = (r0 * r0 + r01 + r1 * r1) * (1.0F / 3);
    const mask16 in_swath = wanted & (lit > 0.0F) & (bin >= 0.0F) & (bin < n_range) &
                            (r01 > static_cast<float>(kNearest_m * kNearest_m));
    if (any(in_swath)) {
      f32x16 gain = parts.gain;
      const f32x16 over = 1.0F / (r01 * turned);
      const f32x16 over2 = 1.0F / r01;  // 1 / mean r^2 is third over2^2
      const f32x16 mean = third * over2 * over2;
      if (cut.echo.any_lobes)
        gain *= cross_section_of_area(
            cut.echo, parts.material,
            max(1.0F / (mean * parts.plane_distance * parts.plane_distance), all_lanes(1.0F)));
      f32x16 sine{};
      if (kSines || cut.echo.elevation.gain != nullptr) {
        const f32x16 middle_d = 0.5F * (d0 + d1);
        const f32x16 middle_h = 0.5F * (h0 + h1);
        // Of a beam's width, which is 1 / cos(e), the middle of the strip has the mean straight below as
        // well.
        const f32x16 range2 = kSines ? middle_d * middle_d + middle_h * middle_h : r01;
        sine = (middle_h + load_floats(cut.lean) * middle_d) / sqrt(range2);
        const f32x16 towards = elevation_gain(cut.echo.elevation, sine);
        gain *= towards * towards;
      }
      f32x16 light = gain * lit * over * (cut.echo.range_normalisation ? 1.0F / mean : mean);
      if (cut.kept[0] != nullptr) {
        const i32x16 at = truncated(select(in_swath, bin, f32x16{})) * kLanes +
                          (lane_numbers<std::int32_t, kFloatLanes>() & 7) +
                          static_cast<std::int32_t>(cut.kept[1] - cut.kept[0]) *
                              (lane_numbers<std::int32_t, kFloatLanes>() >> 3);
        light *= gather(cut.kept[0], at);
      }
      const mask16 has = in_swath & (light > 0.0F);
      const mask16 same = has & (bin == now.bin);
      const mask16 fresh = has & ~same;
      if (const unsigned ended = movemask(fresh & (now.bin >= 0.0F)); ended != 0)
        put<kSines>(ended, now, out);
      if constexpr (kSines)
        now.sine = select(same, now.sine + light * sine, select(fresh, light * sine, now.sine));
      now.light = select(same, now.light + light, select(fresh, light, now.light));
      now.bin = select(fresh, bin, now.bin);
      now.distance = select(fresh, d0 + 0.5F * spacing, now.distance);
      now.material = select(fresh, parts.material, now.material);
    }
    t0 = t1;
    d0 = d1;
    h0 = h1;
    r0 = r1;
    wanted &= ~at_end;
  }
  return true;
}

/// Leaves what is not done of a row in its segments.
OBLIQ_INLINE void keep(const SegmentRows& rows, unsigned left, f64x8 at) {
  if (rows.first >= rows.end) return;
  double* const from = rows.segments->from_m[rows.first];
  store(from, load(from) + at);
  rows.segments->seen[rows.first] = left;
}

template <bool kSines>
OBLIQ_INLINE bool add_rows(const GroundCut& cut, SegmentRows& a, SegmentRows& b, GroundEchoes& out) {
  Running now{load_floats(out.bin_now), load_floats(out.distance_now_m), load_floats(out.light_now),
              load_floats(out.material_now), load_floats(out.sine_now)};
  bool room = true;
  for (; a.first < a.end || b.first < b.end; ++a.first, ++b.first) {
    const Row left(a);
    const Row right(b);
    mask16 wanted = mask16_from(left.seen | right.seen << kLanes);
    Parts parts;
    parts.from = as_floats(left.from, right.from);
    parts.height = as_floats(left.height, right.height);
    parts.rise = as_floats(left.rise, right.rise);
    parts.facing = -as_floats(left.start, right.start);
    parts.plane_distance = as_floats(left.plane_distance, right.plane_distance);
    parts.at = f32x16{};
    parts.end = as_floats(left.length, right.length);
    parts.material = cut.material == nullptr ? f32x16{} : joined(materials_of(cut, a), materials_of(cut, b));
    parts.gain = as_floats(left.width, right.width);
    if (!cut.echo.any_lobes) parts.gain *= gather(cut.echo.gamma_f, truncated(parts.material));
    // Range falls and rises again where the foot of the perpendicular from the antenna lies on a segment.
    const f32x16 rate2 = 1.0F + parts.rise * parts.rise;
    const f32x16 along = parts.from + parts.rise * parts.height;
    const mask16 turns = wanted & (along < 0.0F) & (along + rate2 * parts.end > 0.0F);
    mask16 left_over{};
    if (any(turns)) {
      const f32x16 whole = parts.end;
      const f32x16 turn = clamp(-along / rate2, f32x16{}, whole);
      parts.end = select(turns, turn, whole);
      room = add<kSines>(cut, parts, wanted, now, out);
      left_over = wanted | turns;
      parts.end = whole;
      if (room) {
        parts.at = turn;
        wanted = turns;
        room = add<kSines>(cut, parts, wanted, now, out);
        left_over = wanted;
      }
    } else {
      room = add<kSines>(cut, parts, wanted, now, out);
      left_over = wanted;
    }
    if (!room) {
      const unsigned mask = movemask(left_over);
      keep(a, mask & 0xff, first_half(parts.at));
      keep(b, mask >> kLanes, second_half(parts.at));
      break;
    }
  }
  store(out.bin_now, now.bin);
  store(out.distance_now_m, now.distance);
  store(out.light_now, now.light);
  store(out.material_now, now.material);
  if constexpr (kSines) store(out.sine_now, now.sine);
  return room;
}

}  // namespace

bool ground_echoes(const GroundCut& cut, SegmentRows& a, SegmentRows& b, GroundEchoes& out) {
  return cut.echo.sines ? add_rows<true>(cut, a, b, out) : add_rows<false>(cut, a, b, out);
}

void ground_places(const PlaceOfEchoes& where, const GroundEchoes& echoes, std::uint64_t* place,
                   std::uint64_t* kind) {
  for (int k = 0; k < echoes.n; k += kLanes) {
    const mask8 there = lane_numbers<std::uint64_t, kLanes>() < static_cast<std::uint64_t>(echoes.n - k);
    const u64x8 at = select(there, load_u64(echoes.at + k), u64x8{});
    const u64x8 material = select(there, load_u64(echoes.material + k), u64x8{});
    const u64x8 bin = at >> GroundEchoes::kLog2Runs;
    const u64x8 profile = at & std::uint64_t{GroundEchoes::kRuns - 1};
    const f64x8 distance = converted<double>(load_as<f32x8>(echoes.distance_m + k));
    const f64x8 cells_per_m = gather(where.cells_per_m, bin);
    const f64x8 x = where.antenna_x_m + distance * gather(where.sin_bearing, profile);
    const f64x8 z = where.antenna_z_m + distance * gather(where.cos_bearing, profile);
    const u64x8 level = gather(where.level_bits, bin);
    store(place + k,
          (to_i64(floor(x * cells_per_m)) << 32) | (to_i64(floor(z * cells_per_m)) & 0xffffffffull));
    store(kind + k, level | material | 0xffffffff00000000ull);
  }
}

}  // namespace obliq::OBLIQ_ISA
