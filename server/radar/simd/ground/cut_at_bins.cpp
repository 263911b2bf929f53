// SegmentSampler for eight segments of ground at a time.
#include "server/radar/simd/ground/cut_at_bins.h"

#include "server/radar/simd/ground/range_run.h"

namespace obliq::OBLIQ_ISA {
int cut_at_range_bins(const SegmentCut& bins, const VisibleSegments& segments, int first, SampleBatch& out,
                      bool& rare) {
  const RangeAxis& axis = bins.axis;
  const double bins_per_m = 1 / axis.range_spacing_m;
  const double n_range = axis.n_range;
  const f64x8 sines = load(bins.sin_bearing);
  const f64x8 cosines = load(bins.cos_bearing);
  const f64x8 offsets = load(bins.azimuth_offset_rad);
  const f64x8 azimuths = load(bins.azimuth_bin);
  rare = false;
  for (; first < segments.n; ++first) {
    mask8 wanted = mask_from(segments.seen[first]);
    const f64x8 start = load(segments.start_m[first]);
    const f64x8 rise = load(segments.rise[first]);
    const f64x8 from = load(segments.from_m[first]);
    const f64x8 to = load(segments.to_m[first]);
    const f64x8 from_h = start + from * rise;
    const f64x8 to_h = start + to * rise;
    const f64x8 from_r = sqrt(from * from + from_h * from_h);
    const f64x8 to_r = sqrt(to * to + to_h * to_h);
    const f64x8 nearest = min(from_r, to_r);
    const f64x8 farthest = max(from_r, to_r);
    wanted &= ~((farthest < axis.r_min_m) | (nearest >= axis.r_max_m));
    if (!any(wanted)) continue;

    const f64x8 rate2 = 1.0 + rise * rise;
    const f64x8 along = start * rise;
    const mask8 turns = (along + rate2 * from < 0.0) & (along + rate2 * to > 0.0);
    const mask8 wide = -start * (to - from) > bins.turn_rad * (from * to + from_h * to_h);
    const f64x8 first_bin =
        select(nearest < axis.r_min_m, broadcast(-1), floor((nearest - axis.r_min_m) * bins_per_m));
    const f64x8 last_bin =
        select(farthest >= axis.r_max_m, broadcast(n_range), floor((farthest - axis.r_min_m) * bins_per_m));
    const f64x8 cuts = select(wanted, last_bin - first_bin, f64x8{});
    // Eights are stored whole: what is behind the last sample is overwritten.
    const double room = kBatch - kLanes - out.n;
    const mask8 crowded = (cuts + 1.0) * static_cast<double>(kLanes) > room;
    if (any(wanted & (turns | wide | (cuts * static_cast<double>(kLanes) > kBatch / 4.0)))) {
      rare = true;
      return first;
    }
    if (any(crowded)) return first;

    const mask8 outwards = to_r > from_r;
    const f64x8 width = load(segments.width_rad[first]);
    const f64x8 cells = load(segments.cell[first]);
    const f64x8 plane_distance = load(segments.plane_distance_m[first]);
    const f64x8 root_sign = select(outwards, broadcast(1), broadcast(-1));
    f64x8 d0 = from;
    f64x8 r0 = from_r;
    for (double k = 1; any(wanted); ++k) {
      // The next edge, or the segment's end.
      const mask8 at_end = cuts < k;
      const f64x8 edge_index = select(outwards, first_bin + k, last_bin - k + 1.0);
      const f64x8 edge = axis.edge_m(edge_index);
      const f64x8 d1 = select(at_end, to, edge_at(rate2, along, -start, root_sign, edge, d0, to));
      const f64x8 r1 = select(at_end, to_r, edge);
      const f64x8 bin = select(at_end, select(outwards, last_bin, first_bin),
                               select(outwards, edge_index - 1.0, edge_index));
      const auto part = part_of(-start * (d1 - d0), d0, start + d0 * rise, r0, d1, start + d1 * rise, r1);
      const unsigned kept = movemask(wanted & (part.turn_sin > 0.0) & (bin >= 0.0) & (bin < n_range));
      if (kept != 0) {
        const f64x8 over_r = 1.0 / part.range_m;
        const int n = out.n;
        store_i32(out.azimuth_bin + n, compress(kept, azimuths));
        store(out.slant_range_m + n, compress(kept, part.range_m));
        store(out.solid_angle_sr + n, compress(kept, width * part.share));
        store(out.cos_incidence + n, compress(kept, min(broadcast(1), plane_distance * over_r)));
        store(out.azimuth_offset_rad + n, compress(kept, offsets));
        store(out.sin_elevation + n, compress(kept, part.height_m * over_r));
        store(out.x_m + n, compress(kept, bins.ground.antenna_x_m + part.distance_m * sines));
        store(out.z_m + n, compress(kept, bins.ground.antenna_z_m + part.distance_m * cosines));
        const u64x8 cell = to_u64(compress(kept, cells));
        const int count = __builtin_popcount(kept);
        for (int s = 0; s < count; ++s) {
          out.face[n + s] = kNoFace;
          out.material[n + s] = 0;
        }
        const auto nx = static_cast<std::uint64_t>(bins.ground.grid.nx);
        if (bins.material != nullptr) {
          for (int s = 0; s < count; ++s)
            out.material[n + s] = bins.material[cell[s] / nx * (nx - 1) + cell[s] % nx];
        }
        if (bins.raster_gamma != nullptr) {
          for (int s = 0; s < count; ++s)
            out.raster_gamma[n + s] = bins.raster_gamma[cell[s] / nx * (nx - 1) + cell[s] % nx];
        }
        out.n = n + count;
      }
      d0 = d1;
      r0 = r1;
      wanted &= ~at_end;
    }
  }
  return first;
}

}  // namespace obliq::OBLIQ_ISA
