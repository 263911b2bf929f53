#pragma once
#include "server/radar/simd/grid_view.h"
#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {

/// Asks for the heights of the cells around grid coordinates (u, v), those that lie on the grid.
OBLIQ_INLINE void prefetch_cells(const LaneGrid& grid, f64x8 u, f64x8 v) {
  const mask8 on_grid = (u >= 0.0) & (v >= 0.0) & (u < grid.nx - 1.0) & (v < grid.nz - 1.0);
  std::uint64_t at[kLanes];
  store(at, to_u64(select(on_grid, floor(v) * static_cast<double>(grid.nx) + floor(u), f64x8{})));
  for (const std::uint64_t node : at) {
    __builtin_prefetch(grid.y_m + node);
    __builtin_prefetch(grid.y_m + node + static_cast<std::uint64_t>(grid.nx));
  }
}

}  // namespace obliq::OBLIQ_ISA
