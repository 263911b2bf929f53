// SegmentSampler for eight pieces of ground at a time, to the bit.
#include "server/radar/simd/cut_at_bins.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// A part of each piece, in one range bin: what it becomes as a sample.
struct Part {
  f64x8 range, share, height, distance;
  mask8 any;
};

/// SegmentSampler::part. The piece is the line h = start + rise d.
OBLIQ_INLINE Part part_of(f64x8 start, f64x8 rise, f64x8 d0, f64x8 r0, f64x8 d1, f64x8 r1) {
  const f64x8 h0 = start + d0 * rise;
  const f64x8 h1 = start + d1 * rise;
  const f64x8 cross = -start * (d1 - d0);
  const f64x8 dot = d0 * d1 + h0 * h1;
  const f64x8 r01 = r0 * r1;
  const f64x8 mean = r01 * sqrt(3.0 / (r0 * r0 + r01 + r1 * r1));
  return {clamp(mean, min(r0, r1), max(r0, r1)), cross * (d0 * r1 + d1 * r0) / (r01 * (r01 + dot)),
          (h0 + h1) / 2.0, (d0 + d1) / 2.0, cross > 0.0};
}

}  // namespace

int cut_ground(const PieceBins& bins, const GroundPieces& pieces, int first, SampleBatch& out, bool& rare) {
  const double bins_per_m = 1 / bins.range_spacing_m;
  const double n_range = bins.n_range;
  const f64x8 sines = load(bins.sin_bearing);
  const f64x8 cosines = load(bins.cos_bearing);
  const f64x8 offsets = load(bins.azimuth_offset_rad);
  const f64x8 azimuths = load(bins.azimuth_bin);
  rare = false;
  for (; first < pieces.n; ++first) {
    mask8 wanted = mask_from(pieces.seen[first]);
    const f64x8 start = load(pieces.start_m[first]);
    const f64x8 rise = load(pieces.rise[first]);
    const f64x8 from = load(pieces.from_m[first]);
    const f64x8 to = load(pieces.to_m[first]);
    const f64x8 from_h = start + from * rise;
    const f64x8 to_h = start + to * rise;
    const f64x8 from_r = sqrt(from * from + from_h * from_h);
    const f64x8 to_r = sqrt(to * to + to_h * to_h);
    const f64x8 nearest = min(from_r, to_r);
    const f64x8 farthest = max(from_r, to_r);
    wanted &= ~((farthest < bins.r_min_m) | (nearest >= bins.r_max_m));
    if (!any(wanted)) continue;

    const f64x8 rate2 = 1.0 + rise * rise;
    const f64x8 along = start * rise;
    const mask8 turns = (along + rate2 * from < 0.0) & (along + rate2 * to > 0.0);
    const mask8 wide = -start * (to - from) > bins.turn_rad * (from * to + from_h * to_h);
    const f64x8 first_bin =
        select(nearest < bins.r_min_m, broadcast(-1), floor((nearest - bins.r_min_m) * bins_per_m));
    const f64x8 last_bin =
        select(farthest >= bins.r_max_m, broadcast(n_range), floor((farthest - bins.r_min_m) * bins_per_m));
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
    const f64x8 width = load(pieces.width_rad[first]);
    const f64x8 cells = load(pieces.cell[first]);
    const f64x8 plane_distance = load(pieces.plane_distance_m[first]);
    const f64x8 root_sign = select(outwards, broadcast(1), broadcast(-1));
    f64x8 d0 = from;
    f64x8 r0 = from_r;
    for (double k = 1; any(wanted); ++k) {
      // The next edge, or the piece's end. |A + t D|^2 = edge^2, as in SegmentSampler::cut_at_bins.
      const mask8 at_end = cuts < k;
      const f64x8 edge_index = select(outwards, first_bin + k, last_bin - k + 1.0);
      const f64x8 edge = select(edge_index == n_range, broadcast(bins.r_max_m),
                                bins.r_min_m + edge_index * bins.range_spacing_m);
      const f64x8 root = sqrt(max(f64x8{}, rate2 * edge * edge - start * start));
      const f64x8 at_edge = clamp((root_sign * root - along) / rate2, d0, to);
      const f64x8 d1 = select(at_end, to, at_edge);
      const f64x8 r1 = select(at_end, to_r, edge);
      const f64x8 bin = select(at_end, select(outwards, last_bin, first_bin),
                               select(outwards, edge_index - 1.0, edge_index));
      const Part part = part_of(start, rise, d0, r0, d1, r1);
      const unsigned kept = movemask(wanted & part.any & (bin >= 0.0) & (bin < n_range));
      if (kept != 0) {
        const f64x8 over_r = 1.0 / part.range;
        const int n = out.n;
        store_i32(out.azimuth_bin + n, compress(kept, azimuths));
        store(out.slant_range_m + n, compress(kept, part.range));
        store(out.solid_angle_sr + n, compress(kept, width * part.share));
        store(out.cos_incidence + n, compress(kept, min(broadcast(1), plane_distance * over_r)));
        store(out.azimuth_offset_rad + n, compress(kept, offsets));
        store(out.sin_elevation + n, compress(kept, part.height * over_r));
        store(out.x_m + n, compress(kept, bins.antenna_x_m + part.distance * sines));
        store(out.z_m + n, compress(kept, bins.antenna_z_m + part.distance * cosines));
        const u64x8 cell = to_u64(compress(kept, cells));
        const int count = __builtin_popcount(kept);
        for (int s = 0; s < count; ++s) {
          out.face[n + s] = kNoFace;
          out.material[n + s] = 0;
        }
        if (bins.material != nullptr) {
          for (int s = 0; s < count; ++s) {
            const auto nx = static_cast<std::uint64_t>(bins.nx);
            out.material[n + s] = bins.material[cell[s] / nx * (nx - 1) + cell[s] % nx];
          }
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
