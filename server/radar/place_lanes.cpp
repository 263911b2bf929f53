// BinGrid::range_bin and SpeckleField::scatterer for eight samples at a time.
#include "server/radar/place_lanes.h"

#include "server/radar/lanes.h"

namespace obliq::OBLIQ_ISA {

void place_samples(const SwathCells& cells, int n, const double* slant_range_m, const double* x_m,
                   const double* z_m, PlacedSamples& placed) {
  const double last = cells.n_range - 1;
  for (int k = 0; k < n; k += kLanes) {
    const Lanes r = load_lanes(slant_range_m + k);
    const LaneFlags inside = (r >= cells.r_min_m) & (r < cells.r_max_m);
    const Lanes bin = floor_of(select(inside, (r - cells.r_min_m) / cells.range_spacing_m, Lanes{}));
    const Lanes range_bin =
        select(inside, select(bin > last, all_lanes(last), bin), all_lanes(PlacedSamples::kOutside));
    store_ints(placed.range_bin + k, range_bin);
    store_lanes(placed.range2_m2 + k, r * r);

    // The exponent is floor(log2 r).
    const Lanes exponent = doubles_of((bits_of(r) >> 52) & 0x7ff) - 1023.0;
    const LaneBits octave = integers_of(clamp(exponent, Lanes{}, all_lanes(63)));
    const Lanes cells_per_m = gather(cells.cells_per_m, octave);
    const LaneBits x = whole_bits(floor_of(load_lanes(x_m + k) * cells_per_m));
    const LaneBits z = whole_bits(floor_of(load_lanes(z_m + k) * cells_per_m));
    store_bits(placed.cell + k, (x << 32) | (z & 0xffffffffull));
    store_bits(placed.level + k, (whole_bits(gather(cells.level, octave)) & 0xffff) << 8);
  }
}

}  // namespace obliq::OBLIQ_ISA
