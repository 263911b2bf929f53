// From visible segments of ground to the light of each range bin, sixteen profiles at a time: cut at the
// edges of bins, cross section, radar equation. Nothing in between goes to memory.
#include "server/radar/simd/ground/ground_echoes.h"

#include "server/radar/simd/echoes/cell_key.h"
#include "server/radar/simd/ground/running_ground.h"
#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// One row of eight segments in doubles, or none.
struct Row {
  unsigned seen = 0;
  f64x8 start{}, rise{}, from{}, length{}, height{}, width{}, plane_distance{};

  OBLIQ_INLINE Row(const SegmentRows& rows, bool wants_planes) {
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
    if (wants_planes) plane_distance = load(segments.plane_distance_m[row]);
  }
};

/// What a table [nz - 1][nx - 1] has of the cells of a row's segments; 0 where there are none.
template <typename T>
OBLIQ_INLINE f32x8 of_cells(const GroundCut& cut, const T* table, const SegmentRows& rows) {
  if (rows.first >= rows.end) return f32x8{};
  const VisibleSegments& segments = *rows.segments;
  const int row = rows.first;
  const auto nx = static_cast<std::uint64_t>(cut.nx);
  return lane_by_lane<float, kLanes>([&](int lane) {
    if ((segments.seen[row] >> lane & 1) == 0) return 0.0F;
    const auto cell = static_cast<std::uint64_t>(segments.cell[row][lane]);
    return static_cast<float>(table[cell / nx * (nx - 1) + cell % nx]);
  });
}

/// What a table says of materials: mostly of one.
template <int n>
OBLIQ_INLINE Floats<n> of_materials(const float* table, Floats<n> material) {
  const float first = material[0];
  if (any(material != first)) return gather(table, truncated(material));
  return in_all<n>(table[static_cast<int>(first)]);
}

/// Straight segments: (d, h) = (from + t, height + rise t), t from `at` to `end`.
template <int n>
struct Parts {
  Floats<n> from, height, rise, facing;  // facing: d rise - h, the same all along
  Floats<n> at, end;
  Floats<n> gain;  // width, and gamma where that is a constant
  Floats<n> material, plane_distance;
  Floats<n> raster_gamma;  // only with GroundCut::raster_gamma
  Where<n> water;          // only with a sea; gain is without its material's gamma
};

/// A cross section by area, as a gamma raster has it (World::raster_gamma).
template <typename Float>
OBLIQ_INLINE Float as_raster_says(Float raster_gamma, Float cross_section) {
  return select(raster_gamma < 0.0F, -raster_gamma, raster_gamma * cross_section);
}

/// ScatteringTable's cross section by area, with lobes.
OBLIQ_INLINE f32x8 cross_section_of(const EchoTable& table, f32x8 material, f32x8 sec2) {
  return converted<float>(
      cross_section_of_area(table, to_u64(converted<double>(material)), converted<double>(sec2)));
}
OBLIQ_INLINE f32x16 cross_section_of(const EchoTable& table, f32x16 material, f32x16 sec2) {
  return joined(cross_section_of(table, low_half(material), low_half(sec2)),
                cross_section_of(table, high_half(material), high_half(sec2)));
}

/// Light of the lanes in `seen`, times the gamma of those that are water. (d2, h2): the sum of a piece's
/// ends; over_range2: and of 1 over their ranges.
template <int n>
OBLIQ_INLINE Floats<n> with_sea(const GroundCut& cut, const Parts<n>& parts, Where<n> seen, Floats<n> light,
                                Floats<n> d2, Floats<n> h2, Floats<n> over_range2, TableWindow& window) {
  const Where<n> water = seen & parts.water;
  if (!any(water)) return light;
  const Floats<n> fall2 =
      d2 * (load_as<Floats<n>>(cut.sea_lean) + load_as<Floats<n>>(cut.half_sea_curve) * d2) - h2;
  const Floats<n> gamma = sea_gamma(*cut.echo.sea, 0.25F * (over_range2 * fall2), cut.upwind, water, window);
  return select(water, light * gamma, light);
}

/// Adds the parts of the profiles in `wanted`, whose range rises or falls all along. False: the list is full;
/// those that are not done are in `wanted`, from parts.at on.
template <bool kSines, int n, class Labels>
OBLIQ_INLINE bool add(const GroundCut& cut, Parts<n>& parts, Where<n>& wanted, Running<n>& now,
                      GroundEchoes& out, Labels& labels, TableWindow& sea) {
  using Float = Floats<n>;
  const auto r_min = static_cast<float>(cut.axis.r_min_m);
  const auto spacing = static_cast<float>(cut.axis.range_spacing_m);
  const float bins_per_m = 1 / spacing;
  const auto n_range = static_cast<float>(cut.axis.n_range);
  // An edge like the others: what is nearer must not depend on where the swath ends.
  const float r_max = r_min + n_range * spacing;
  const Float rate2 = 1.0F + parts.rise * parts.rise;
  const Float first_d = parts.from + parts.at;
  const Float first_h = parts.height + parts.rise * parts.at;
  const Float last_d = parts.from + parts.end;
  const Float last_h = parts.height + parts.rise * parts.end;
  const Float first_r = sqrt(first_d * first_d + first_h * first_h);
  const Float last_r = sqrt(last_d * last_d + last_h * last_h);
  const Float nearest = min(first_r, last_r);
  const Float farthest = max(first_r, last_r);
  wanted &= ~((farthest < r_min) | (nearest >= r_max));
  if (!any(wanted)) return true;
  const auto bin_of = [&](Float r) __attribute__((always_inline)) {
    const Float at = clamp((r - r_min) * bins_per_m, in_all<n>(-1.0F), in_all<n>(n_range));
    return converted<float>(truncated(at + 1.0F)) - 1.0F;
  };
  const Float first_bin = bin_of(nearest);
  const Float last_bin = bin_of(farthest);
  const Float cuts = select(wanted, last_bin - first_bin, Float{});
  const Where<n> outwards = last_r > first_r;
  const Float sign = select(outwards, in_all<n>(1.0F), in_all<n>(-1.0F));
  // Range squared grows by t (2 along + rate2 t) from where the part begins.
  const Float along = first_d + parts.rise * first_h;
  const Float along2 = along * along;
  Float t0{};
  Float d0 = first_d;
  Float h0 = first_h;
  Float r0 = first_r;
  const Float length = parts.end - parts.at;
  for (float k = 1; any(wanted); ++k) {
    if (out.n > GroundEchoes::kMost - GroundEchoes::kSpare) {
      parts.at += t0;
      return false;
    }
    const Where<n> at_end = cuts < k;
    Float t1 = length;
    Float r1 = last_r;
    Float bin = first_bin;
    if (k > 1 || any(wanted & ~at_end)) {
      const Float edge_index = select(outwards, first_bin + k, last_bin - k + 1.0F);
      const Float edge = r_min + edge_index * spacing;
      const Float grown = (edge - first_r) * (edge + first_r);
      const Float root = sqrt(max(along2 + rate2 * grown, Float{}));
      const Float at_edge = clamp(grown / (along + sign * root), t0, length);
      t1 = select(at_end, length, at_edge);
      r1 = select(at_end, last_r, edge);
      bin = select(at_end, select(outwards, last_bin, first_bin),
                   select(outwards, edge_index - 1.0F, edge_index));
    }
    // Solid angle of a strip one radian wide: part_of (range_run.h). The mean of 1 / r^2 over it:
    // mean_power_range_m.
    const Float d1 = first_d + t1;
    const Float h1 = first_h + parts.rise * t1;
    const Float r01 = r0 * r1;
    const Float turned = r01 + (d0 * d1 + h0 * h1);
    const Float lit = parts.facing * (t1 - t0) * (d0 * r1 + d1 * r0);
    const Float third = (r0 * r0 + r01 + r1 * r1) * (1.0F / 3);
    const Where<n> in_swath = wanted & (lit > 0.0F) & (bin >= 0.0F) & (bin < n_range) &
                              (r01 > static_cast<float>(kNearest_m * kNearest_m));
    if (any(in_swath)) {
      Float gain = parts.gain;
      const Float over = 1.0F / (r01 * turned);
      const Float over2 = turned * over;  // 1 / r01; 1 / mean r^2 is third over2^2
      const Float mean = third * over2 * over2;
      if (cut.echo.any_lobes) {
        Float sigma = cross_section_of(
            cut.echo, parts.material,
            max(1.0F / (mean * parts.plane_distance * parts.plane_distance), in_all<n>(1.0F)));
        if (cut.raster_gamma != nullptr) sigma = as_raster_says(parts.raster_gamma, sigma);
        gain *= sigma;
      }
      Float sine{};
      // Labels have one text of both.
      const bool widths = kSines && (!Labels::kWanted || cut.echo.sines);
      if (widths || cut.echo.elevation.gain != nullptr) {
        const Float middle_d = 0.5F * (d0 + d1);
        const Float middle_h = 0.5F * (h0 + h1);
        // Of a beam's width, which is 1 / cos(e), the middle of the strip has the mean straight below as
        // well.
        const Float range2 = widths ? middle_d * middle_d + middle_h * middle_h : r01;
        sine = (middle_h + load_as<Float>(cut.lean) * middle_d) / sqrt(range2);
        const Float towards = elevation_gain(cut.echo.elevation, sine);
        gain *= towards * towards;
      }
      Float light = gain * lit * over * (cut.echo.range_normalisation ? 1.0F / mean : mean);
      if (cut.kept[0] != nullptr) {
        const Numbers<n> at =
            truncated(select(in_swath, bin, Float{})) * kLanes + (lane_numbers<std::int32_t, n>() & 7) +
            static_cast<std::int32_t>(cut.kept[1] - cut.kept[0]) * (lane_numbers<std::int32_t, n>() >> 3);
        light *= gather(cut.kept[0], at);
      }
      const Where<n> has = in_swath & (light > 0.0F);
      const Where<n> same = has & (bin == now.bin);
      const Where<n> fresh = has & ~same;
      if (const unsigned ended = movemask(fresh & (now.bin >= 0.0F)); ended != 0)
        put<kSines>(ended, now, out);
      // Behind what decides which bin is on the way, so that nothing waits for it.
      if (cut.echo.sea != nullptr)
        light = with_sea<n>(cut, parts, has, light, d0 + d1, h0 + h1, over2 * (r0 + r1), sea);
      if constexpr (kSines)
        now.sine = select(same, now.sine + light * sine, select(fresh, light * sine, now.sine));
      now.light = select(same, now.light + light, select(fresh, light, now.light));
      now.bin = select(fresh, bin, now.bin);
      now.distance = select(fresh, d0 + 0.5F * spacing, now.distance);
      now.material = select(fresh, parts.material, now.material);
      if constexpr (Labels::kWanted) labels.add(has, bin, parts.material, d0, h0, d1, h1, light);
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

/// The segments of one row of each run, or of one run.
template <int n, typename Value>
OBLIQ_INLINE Floats<n> of_rows(const Row& left, const Row& right, const Value& value) {
  if constexpr (n == kLanes)
    return converted<float>(value(left));
  else
    return joined(converted<float>(value(left)), converted<float>(value(right)));
}
#define OBLIQ_OF_ROWS(what) \
  of_rows<n>(               \
      left, right, [](const Row& row) __attribute__((always_inline)) { return row.what; })

template <bool kSines, int n, class Labels>
OBLIQ_INLINE bool add_rows(const GroundCut& cut, SegmentRows& a, SegmentRows& b, GroundEchoes& out,
                           GroundStretches* stretches) {
  using Float = Floats<n>;
  Running<n> now(out);
  Labels labels(stretches);
  TableWindow sea{SeaTable::kFirstStep};
  bool room = true;
  for (; a.first < a.end || b.first < b.end; ++a.first, ++b.first) {
    if (labels.is_full()) {
      room = false;
      break;
    }
    const Row left(a, cut.echo.any_lobes);
    const Row right(b, cut.echo.any_lobes);
    Where<n> wanted = flags_of(static_cast<const Where<n>*>(nullptr), left.seen | right.seen << kLanes);
    Parts<n> parts;
    parts.from = OBLIQ_OF_ROWS(from);
    parts.height = OBLIQ_OF_ROWS(height);
    parts.rise = OBLIQ_OF_ROWS(rise);
    parts.facing = -OBLIQ_OF_ROWS(start);
    parts.plane_distance = OBLIQ_OF_ROWS(plane_distance);
    parts.at = Float{};
    parts.end = OBLIQ_OF_ROWS(length);
    parts.gain = OBLIQ_OF_ROWS(width);
    parts.material = parts.raster_gamma = Float{};
    const auto of_both = [&](const auto* table) __attribute__((always_inline)) {
      if constexpr (n == kLanes)
        return of_cells(cut, table, a);
      else
        return joined(of_cells(cut, table, a), of_cells(cut, table, b));
    };
    if (cut.material != nullptr) parts.material = of_both(cut.material);
    if (cut.raster_gamma != nullptr) parts.raster_gamma = of_both(cut.raster_gamma);
    if (cut.echo.sea != nullptr) {
      const Float over_gamma = of_materials(cut.echo.sea->over_gamma, parts.material);
      parts.water = over_gamma > 0.0F;
      // A raster of gamma in the material's place stands in the place of the sea as well.
      if (cut.raster_gamma != nullptr) parts.water &= ~(parts.raster_gamma < 0.0F);
      parts.gain *= select(parts.water, over_gamma, in_all<n>(1.0F));
    }
    if (!cut.echo.any_lobes) {
      Float gamma = of_materials(cut.echo.gamma_f, parts.material);
      if (cut.raster_gamma != nullptr) gamma = as_raster_says(parts.raster_gamma, gamma);
      parts.gain *= gamma;
    }
    // Range falls and rises again where the foot of the perpendicular from the antenna lies on a segment.
    const Float rate2 = 1.0F + parts.rise * parts.rise;
    const Float along = parts.from + parts.rise * parts.height;
    const Where<n> turns = wanted & (along < 0.0F) & (along + rate2 * parts.end > 0.0F);
    Where<n> left_over{};
    if (any(turns)) {
      const Float whole = parts.end;
      const Float turn = clamp(-along / rate2, Float{}, whole);
      parts.end = select(turns, turn, whole);
      room = add<kSines>(cut, parts, wanted, now, out, labels, sea);
      left_over = wanted | turns;
      parts.end = whole;
      if (room) {
        parts.at = turn;
        wanted = turns;
        room = add<kSines>(cut, parts, wanted, now, out, labels, sea);
        left_over = wanted;
      }
    } else {
      room = add<kSines>(cut, parts, wanted, now, out, labels, sea);
      left_over = wanted;
    }
    if (!room) {
      const unsigned mask = movemask(left_over);
      if constexpr (n == kLanes) {
        keep(a, mask, converted<double>(parts.at));
      } else {
        keep(a, mask & 0xff, converted<double>(low_half(parts.at)));
        keep(b, mask >> kLanes, converted<double>(high_half(parts.at)));
      }
      break;
    }
  }
  now.keep(out);
  labels.keep();
  return room;
}
#undef OBLIQ_OF_ROWS

template <bool kSines>
OBLIQ_INLINE bool add_any_rows(const GroundCut& cut, SegmentRows& a, SegmentRows& b, GroundEchoes& out) {
  return b.first < b.end ? add_rows<kSines, kFloatLanes, NoStretch<kFloatLanes>>(cut, a, b, out, nullptr)
                         : add_rows<kSines, kLanes, NoStretch<kLanes>>(cut, a, b, out, nullptr);
}

}  // namespace

bool ground_echoes(const GroundCut& cut, SegmentRows& a, SegmentRows& b, GroundEchoes& out,
                   GroundStretches* stretches) {
  if (stretches != nullptr)
    return add_rows<true, kFloatLanes, Stretch<kFloatLanes>>(cut, a, b, out, stretches);
  return cut.echo.sines ? add_any_rows<true>(cut, a, b, out) : add_any_rows<false>(cut, a, b, out);
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
    const f64x8 x = where.antenna_x_m + distance * of_sixteen(where.sin_bearing, profile);
    const f64x8 z = where.antenna_z_m + distance * of_sixteen(where.cos_bearing, profile);
    store(place + k, place_of_cell(x, z, cells_per_m));
    store(kind + k, level_in_kind(cells_per_m) | material | 0xffffffff00000000ull);
  }
}

}  // namespace obliq::OBLIQ_ISA
