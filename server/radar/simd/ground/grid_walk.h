#pragma once
// Eight vertical profiles that march side by side: their state in memory, and heights before they are needed.
#include "server/radar/simd/ground/ground_cells.h"
#include "server/radar/simd/ground/profiles.h"

namespace obliq::OBLIQ_ISA {

OBLIQ_INLINE ProfileRates<f64x8> rates_of(const GroundView& ground, const WalkingProfiles& profiles) {
  return profile_rates(ground, load(profiles.sin_bearing), load(profiles.cos_bearing));
}

OBLIQ_INLINE Cells<f64x8> cells_of(const WalkingProfiles& profiles) {
  return {load(profiles.d_m), load(profiles.i), load(profiles.j)};
}
OBLIQ_INLINE void store_cells(WalkingProfiles& profiles, const Cells<f64x8>& cells) {
  store(profiles.d_m, cells.d);
  store(profiles.i, cells.i);
  store(profiles.j, cells.j);
}

/// Asks for the heights of the cells around grid coordinates (u, v), those that lie on the grid.
OBLIQ_INLINE void prefetch_cells(const GridView& grid, f64x8 u, f64x8 v) {
  const mask8 on_grid = (u >= 0.0) & (v >= 0.0) & (u < grid.nx - 1.0) & (v < grid.nz - 1.0);
  std::uint64_t at[kLanes];
  store(at, to_u64(select(on_grid, floor(v) * static_cast<double>(grid.nx) + floor(u), f64x8{})));
  for (const std::uint64_t node : at) {
    __builtin_prefetch(grid.y_m + node);
    __builtin_prefetch(grid.y_m + node + static_cast<std::uint64_t>(grid.nx));
  }
}
/// How many nodes further the heights lie that profiles come to 32 cells later: memory has answered by then.
/// Of the two rows of nodes that they go between, the farther one: the other was asked for before, or lies
/// along the way.
OBLIQ_INLINE f64x8 nodes_ahead(const GridView& grid, const ProfileRates<f64x8>& p) {
  const double cells = 32 * grid.cell_m;
  return (nearest_integer(cells * p.rate_v) + p.ahead_j) * static_cast<double>(grid.nx) +
         nearest_integer(cells * p.rate_u);
}
/// Asks for them; number: of the cells that profiles are in (number_of). Off the grid as well, where it asks
/// in vain.
OBLIQ_INLINE void prefetch_ahead(const GridView& grid, f64x8 number, f64x8 ahead) {
  std::uint64_t at[kLanes];
  store(at, to_i64(number + ahead));
  for (const std::uint64_t node : at)
    __builtin_prefetch(
        reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(grid.y_m) + node * sizeof(float)));
}

}  // namespace obliq::OBLIQ_ISA
