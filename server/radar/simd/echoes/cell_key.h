#pragma once
// Ground cells as keys of scatterers (ScattererKey) have them. A cell's side is 2^level metres.
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

#if defined(OBLIQ_ISA)

/// ScattererKey::place of the cells that points lie in.
OBLIQ_INLINE u64x8 place_of_cell(f64x8 x_m, f64x8 z_m, f64x8 cells_per_m) {
  return (to_i64(floor(x_m * cells_per_m)) << 32) | (to_i64(floor(z_m * cells_per_m)) & 0xffffffffull);
}

/// The level of such cells where ScattererKey::kind has it: of a power of 2 the exponent says it.
OBLIQ_INLINE u64x8 level_in_kind(f64x8 cells_per_m) {
  return ((std::uint64_t{1023} - (as_bits(cells_per_m) >> 52)) & std::uint64_t{0xffff}) << 8;
}

/// The side of cells of that kind, m.
OBLIQ_INLINE f64x8 side_of_cell(u64x8 kind) {
  const u64x8 level = ((kind >> 8) & 0xffff) ^ 0x8000;  // of either sign, from the least one on
  return as_doubles((level - std::uint64_t{0x8000 - 1023}) << 52);
}

#endif

}  // namespace obliq
