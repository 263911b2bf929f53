// BinGrid::range_bin, SpeckleField::scatterer and ScatteringTable::cross_section_m2 of constant gamma for
// eight samples at a time.
#include "server/radar/simd/bin_samples.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {

void place_samples(const SwathCells& cells, const EchoFactors& factors, const SampleBatch& samples,
                   PlacedSamples& placed) {
  const double last = cells.n_range - 1;
  for (int k = 0; k < samples.n; k += kLanes) {
    const f64x8 r = load(samples.slant_range_m + k);
    const mask8 inside = (r >= cells.r_min_m) & (r < cells.r_max_m);
    const f64x8 bin = floor(select(inside, (r - cells.r_min_m) / cells.range_spacing_m, f64x8{}));
    const f64x8 range_bin =
        select(inside, select(bin > last, broadcast(last), bin), broadcast(PlacedSamples::kOutside));
    store_i32(placed.range_bin + k, range_bin);
    const f64x8 r2 = r * r;
    store(placed.range2_m2 + k, r2);
    const f64x8 gamma = gather(factors.gamma, load_u64(samples.material + k));
    store(placed.sigma_m2 + k, gamma * (load(samples.solid_angle_sr + k) * r2));
    store(placed.spreading + k, factors.range_normalisation ? broadcast(1) : r2 * r2);

    // The exponent is floor(log2 r).
    const f64x8 exponent = to_doubles((as_bits(r) >> 52) & 0x7ff) - 1023.0;
    const u64x8 octave = to_u64(clamp(exponent, f64x8{}, broadcast(63)));
    const f64x8 cells_per_m = gather(cells.cells_per_m, octave);
    const u64x8 x = to_i64(floor(load(samples.x_m + k) * cells_per_m));
    const u64x8 z = to_i64(floor(load(samples.z_m + k) * cells_per_m));
    store(placed.cell + k, (x << 32) | (z & 0xffffffffull));
    store(placed.level + k, (to_i64(gather(cells.level, octave)) & 0xffff) << 8);
  }
}

}  // namespace obliq::OBLIQ_ISA
