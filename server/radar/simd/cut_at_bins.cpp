// PieceSampler for eight pieces of ground at a time, to the bit.
#include "server/radar/simd/cut_at_bins.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// A part of each piece, in one range bin: what it becomes as a sample.
struct Part {
  Lanes range, share, height, distance;
  LaneFlags any;
};

/// PieceSampler::part. The piece is the line h = start + rise d.
OBLIQ_LANES Part part_of(Lanes start, Lanes rise, Lanes d0, Lanes r0, Lanes d1, Lanes r1) {
  const Lanes h0 = start + d0 * rise;
  const Lanes h1 = start + d1 * rise;
  const Lanes cross = -start * (d1 - d0);
  const Lanes dot = d0 * d1 + h0 * h1;
  const Lanes r01 = r0 * r1;
  const Lanes mean = r01 * sqrt_of(3.0 / (r0 * r0 + r01 + r1 * r1));
  return {clamp(mean, least(r0, r1), greatest(r0, r1)), cross * (d0 * r1 + d1 * r0) / (r01 * (r01 + dot)),
          (h0 + h1) / 2.0, (d0 + d1) / 2.0, cross > 0.0};
}

}  // namespace

int cut_ground(const PieceBins& bins, const GroundPieces& pieces, int first, SampleArrays& out, bool& rare) {
  const double bins_per_m = 1 / bins.range_spacing_m;
  const double n_range = bins.n_range;
  const Lanes sines = load_lanes(bins.sin_bearing);
  const Lanes cosines = load_lanes(bins.cos_bearing);
  const Lanes offsets = load_lanes(bins.azimuth_offset_rad);
  const Lanes azimuths = load_lanes(bins.azimuth_bin);
  rare = false;
  for (; first < pieces.n; ++first) {
    LaneFlags wanted = flags_of(pieces.seen[first]);
    const Lanes start = load_lanes(pieces.start_m[first]);
    const Lanes rise = load_lanes(pieces.rise[first]);
    const Lanes from = load_lanes(pieces.from_m[first]);
    const Lanes to = load_lanes(pieces.to_m[first]);
    const Lanes from_h = start + from * rise;
    const Lanes to_h = start + to * rise;
    const Lanes from_r = sqrt_of(from * from + from_h * from_h);
    const Lanes to_r = sqrt_of(to * to + to_h * to_h);
    const Lanes nearest = least(from_r, to_r);
    const Lanes farthest = greatest(from_r, to_r);
    wanted &= ~((farthest < bins.r_min_m) | (nearest >= bins.r_max_m));
    if (!any(wanted)) continue;

    const Lanes rate2 = 1.0 + rise * rise;
    const Lanes along = start * rise;
    const LaneFlags turns = (along + rate2 * from < 0.0) & (along + rate2 * to > 0.0);
    const LaneFlags wide = -start * (to - from) > bins.turn_rad * (from * to + from_h * to_h);
    const Lanes first_bin =
        select(nearest < bins.r_min_m, all_lanes(-1), floor_of((nearest - bins.r_min_m) * bins_per_m));
    const Lanes last_bin = select(farthest >= bins.r_max_m, all_lanes(n_range),
                                  floor_of((farthest - bins.r_min_m) * bins_per_m));
    const Lanes cuts = select(wanted, last_bin - first_bin, Lanes{});
    const double room = out.most - SampleArrays::kRoom - out.n;
    const LaneFlags crowded = (cuts + 1.0) * static_cast<double>(kLanes) > room;
    if (any(wanted & (turns | wide | (cuts * static_cast<double>(kLanes) > out.most / 4.0)))) {
      rare = true;
      return first;
    }
    if (any(crowded)) return first;

    const LaneFlags outwards = to_r > from_r;
    const Lanes width = load_lanes(pieces.width_rad[first]);
    const Lanes cells = load_lanes(pieces.cell[first]);
    const Lanes plane_distance = load_lanes(pieces.plane_distance_m[first]);
    const Lanes root_sign = select(outwards, all_lanes(1), all_lanes(-1));
    Lanes d0 = from;
    Lanes r0 = from_r;
    for (double k = 1; any(wanted); ++k) {
      // The next edge, or the piece's end. |A + t D|^2 = edge^2, as in PieceSampler::cut_at_bins.
      const LaneFlags at_end = cuts < k;
      const Lanes edge_index = select(outwards, first_bin + k, last_bin - k + 1.0);
      const Lanes edge = select(edge_index == n_range, all_lanes(bins.r_max_m),
                                bins.r_min_m + edge_index * bins.range_spacing_m);
      const Lanes root = sqrt_of(greatest(Lanes{}, rate2 * edge * edge - start * start));
      const Lanes at_edge = clamp((root_sign * root - along) / rate2, d0, to);
      const Lanes d1 = select(at_end, to, at_edge);
      const Lanes r1 = select(at_end, to_r, edge);
      const Lanes bin = select(at_end, select(outwards, last_bin, first_bin),
                               select(outwards, edge_index - 1.0, edge_index));
      const Part part = part_of(start, rise, d0, r0, d1, r1);
      const unsigned kept = mask_of(wanted & part.any & (bin >= 0.0) & (bin < n_range));
      if (kept != 0) {
        const Lanes over_r = 1.0 / part.range;
        const int n = out.n;
        store_ints(out.azimuth_bin + n, compress(kept, azimuths));
        store_lanes(out.slant_range_m + n, compress(kept, part.range));
        store_lanes(out.solid_angle_sr + n, compress(kept, width * part.share));
        store_lanes(out.cos_incidence + n, compress(kept, least(all_lanes(1), plane_distance * over_r)));
        store_lanes(out.azimuth_offset_rad + n, compress(kept, offsets));
        store_lanes(out.sin_elevation + n, compress(kept, part.height * over_r));
        store_lanes(out.x_m + n, compress(kept, bins.antenna_x_m + part.distance * sines));
        store_lanes(out.z_m + n, compress(kept, bins.antenna_z_m + part.distance * cosines));
        const LaneBits cell = integers_of(compress(kept, cells));
        const int count = __builtin_popcount(kept);
        for (int s = 0; s < count; ++s) {
          out.face[n + s] = SampleArrays::kGround;
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
