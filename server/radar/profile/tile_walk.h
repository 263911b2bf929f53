#pragma once
// The tiles of the ground that a vertical profile crosses.
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "server/radar/simd/lanes/exact_math.h"
#include "server/scene/tile_bounds.h"

namespace obliq {

/// The tile of a coordinate along one axis, of `n` from first_m on; the nearest one beyond them.
inline int tile_of(double at_m, double first_m, double tile_m, int n) {
  return static_cast<int>(std::clamp(std::floor((at_m - first_m) / tile_m), 0.0, n - 1.0));
}

/// Calls visit(tile, d0_m, d1_m) for those between two ground distances within the grid, outwards.
template <class Visit>
void over_tiles(const TileBounds& tiles, const HeightGrid& grid, const glm::dvec3& antenna_m, SinCos bearing,
                double from_m, double to_m, const Visit& visit) {
  const double tile_m = tiles.cells() * grid.cell_m;
  const auto to_line = [&](int tile, double first_m, double antenna, double rate) {
    return rate == 0 ? std::numeric_limits<double>::infinity()
                     : (first_m + (rate > 0 ? tile + 1 : tile) * tile_m - antenna) / rate;
  };
  int i = tile_of(antenna_m.x + from_m * bearing.sin, grid.x0_m, tile_m, tiles.tiles_x());
  int j = tile_of(antenna_m.z + from_m * bearing.cos, grid.z0_m, tile_m, tiles.tiles_z());
  for (double d = from_m; d < to_m && i >= 0 && j >= 0 && i < tiles.tiles_x() && j < tiles.tiles_z();) {
    const double to_x = to_line(i, grid.x0_m, antenna_m.x, bearing.sin);
    const double to_z = to_line(j, grid.z0_m, antenna_m.z, bearing.cos);
    const double end = std::clamp(std::min(to_x, to_z), d, to_m);
    visit(tiles.tile(i, j), d, end);
    if (to_x < to_z) {
      i += bearing.sin > 0 ? 1 : -1;
    } else {
      j += bearing.cos > 0 ? 1 : -1;
    }
    d = end;
  }
}

}  // namespace obliq
