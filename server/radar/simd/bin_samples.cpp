// BinGrid::range_bin, SpeckleField::scatterer and ScatteringTable::cross_section_m2 of constant gamma for
// eight samples at a time.
#include "server/radar/simd/bin_samples.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {

void place_samples(const SwathCells& cells, const EchoFactors& factors, const PlaceInput& samples,
                   PlacedSamples& placed) {
  const double last = cells.n_range - 1;
  for (int k = 0; k < samples.n; k += kLanes) {
    const Lanes r = load_lanes(samples.slant_range_m + k);
    const LaneFlags inside = (r >= cells.r_min_m) & (r < cells.r_max_m);
    const Lanes bin = floor_of(select(inside, (r - cells.r_min_m) / cells.range_spacing_m, Lanes{}));
    const Lanes range_bin =
        select(inside, select(bin > last, all_lanes(last), bin), all_lanes(PlacedSamples::kOutside));
    store_ints(placed.range_bin + k, range_bin);
    const Lanes r2 = r * r;
    store_lanes(placed.range2_m2 + k, r2);
    const Lanes gamma = gather(factors.gamma, load_bits(samples.material + k));
    store_lanes(placed.sigma_m2 + k, gamma * (load_lanes(samples.solid_angle_sr + k) * r2));
    store_lanes(placed.spreading + k, factors.range_normalisation ? all_lanes(1) : r2 * r2);

    // The exponent is floor(log2 r).
    const Lanes exponent = doubles_of((bits_of(r) >> 52) & 0x7ff) - 1023.0;
    const LaneBits octave = integers_of(clamp(exponent, Lanes{}, all_lanes(63)));
    const Lanes cells_per_m = gather(cells.cells_per_m, octave);
    const LaneBits x = whole_bits(floor_of(load_lanes(samples.x_m + k) * cells_per_m));
    const LaneBits z = whole_bits(floor_of(load_lanes(samples.z_m + k) * cells_per_m));
    store_bits(placed.cell + k, (x << 32) | (z & 0xffffffffull));
    store_bits(placed.level + k, (whole_bits(gather(cells.level, octave)) & 0xffff) << 8);
  }
}

}  // namespace obliq::OBLIQ_ISA
