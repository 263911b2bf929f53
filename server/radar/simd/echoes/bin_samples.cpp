// BinGrid::range_bin, SpeckleField::scatterer and ScatteringTable::cross_section_m2 of constant gamma for
// eight samples at a time.
#include "server/radar/simd/echoes/bin_samples.h"

#include "server/radar/simd/echoes/cell_key.h"

namespace obliq::OBLIQ_ISA {

void bin_samples(const SwathCells& cells, const EchoFactors& factors, const SampleBatch& samples,
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
    store(placed.cell + k, place_of_cell(load(samples.x_m + k), load(samples.z_m + k), cells_per_m));
    store(placed.level + k, level_in_kind(cells_per_m));
  }
}

// Adds up the samples of each bin by scatterer: a bin has a handful, and a sample is compared with eight
// scatterers at a time.

std::uint32_t sum_scatterers(ScattererLists& lists, std::uint32_t first, std::uint32_t n_bins) {
  std::uint32_t n = lists.n;
  std::uint32_t begin = first == 0 ? 0 : lists.end[first - 1];
  std::uint32_t bin = first;
  for (; bin < n_bins; ++bin) {
    const std::uint32_t end = lists.end[bin];
    if (end - begin > ScattererLists::kLarge) break;
    // Whole eights of the bin's scatterers are looked up in memory, the rest are held in registers: what has
    // just been stored one by one cannot be read as one at once.
    const std::uint32_t first_of_bin = n;
    std::uint32_t held_from = n;
    u64x8 held_place{};
    u64x8 held_kind{};
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint64_t place = lists.place[k];
      const std::uint64_t kind = lists.kind[k];
      const std::uint32_t held = n - held_from;
      std::uint32_t from = held_from;
      unsigned same = ((1u << held) - 1) & movemask((held_place == place) & (held_kind == kind));
      for (std::uint32_t eight = first_of_bin; same == 0 && eight < held_from; eight += kLanes) {
        from = eight;
        same = movemask((load_u64(lists.sum_place + eight) == place) &
                        (load_u64(lists.sum_kind + eight) == kind));
      }
      if (same != 0) {
        lists.sum_power_w[from + static_cast<std::uint32_t>(__builtin_ctz(same))] += lists.power_w[k];
        continue;
      }
      const mask8 here = lane_numbers<std::uint64_t, kLanes>() == held;
      held_place = select(here, u64x8{} + place, held_place);
      held_kind = select(here, u64x8{} + kind, held_kind);
      lists.bin[n] = bin;
      lists.sum_place[n] = place;
      lists.sum_kind[n] = kind;
      lists.sum_power_w[n] = lists.power_w[k];
      if (++n - held_from == kLanes) held_from = n;
    }
    begin = end;
  }
  lists.n = n;
  return bin;
}

}  // namespace obliq::OBLIQ_ISA
