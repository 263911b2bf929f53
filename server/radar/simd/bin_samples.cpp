// BinGrid::range_bin, SpeckleField::scatterer and ScatteringTable::cross_section_m2 of constant gamma for
// eight samples at a time.
#include "server/radar/simd/bin_samples.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {

void bin_samples(const SwathCells& cells, const EchoFactors& factors, const SampleView& samples,
                 BinnedSamples& placed) {
  for (int k = 0; k < samples.n; k += kLanes) {
    const f64x8 r = load(samples.slant_range_m + k);
    store_i32(placed.range_bin + k, cells.axis.bin(r));
    const f64x8 r2 = r * r;
    store(placed.range2_m2 + k, r2);
    const f64x8 gamma = gather(factors.gamma, load_u64(samples.material + k));
    store(placed.sigma_m2 + k, gamma * (load(samples.solid_angle_sr + k) * r2));
    store(placed.spreading + k, factors.range_normalisation ? broadcast(1) : r2 * r2);

    const u64x8 octave = to_u64(octave_of(r));
    const f64x8 cells_per_m = gather(cells.cells_per_m, octave);
    const u64x8 x = to_i64(floor(load(samples.x_m + k) * cells_per_m));
    const u64x8 z = to_i64(floor(load(samples.z_m + k) * cells_per_m));
    store(placed.cell + k, (x << 32) | (z & 0xffffffffull));
    store(placed.level + k, (to_i64(gather(cells.level, octave)) & 0xffff) << 8);
  }
}

}  // namespace obliq::OBLIQ_ISA
