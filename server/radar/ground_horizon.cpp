#include "server/radar/ground_horizon.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

/// Raises a horizon by every corner of the ground's profile; a straight piece is highest at one of its ends.
struct RaiseByGround {
  PlaneHorizon& horizon;
  double antenna_y_m;

  void ground(const GroundPiece& piece) {
    horizon.raise(piece.d0_m, piece.start_m + piece.rise * piece.d0_m - antenna_y_m, false);
    horizon.raise(piece.d1_m, piece.start_m + piece.rise * piece.d1_m - antenna_y_m, false);
  }
  static void gap(double, double) {}
  static bool enough() { return false; }
};

}  // namespace

PlaneHorizon ground_horizon(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing, double to_m) {
  const HeightGrid& grid = scene.world().grid;
  const TileBounds& tiles = scene.tiles();
  PlaneHorizon horizon;
  const GroundWalk whole(grid, antenna_m, bearing.sin, bearing.cos, 0, to_m);
  if (whole.done()) return horizon;
  const double from_m = whole.at_m();
  const double tile_m = TileBounds::kCells * grid.cell_m;
  double d = std::min(to_m, whole.end_m());
  const auto tile_of = [&](double at, double first, int n) {
    return std::clamp(static_cast<int>(std::floor((at - first) / tile_m)), 0, n - 1);
  };
  int ti = tile_of(antenna_m.x + d * bearing.sin, grid.x0_m, tiles.tiles_x());
  int tj = tile_of(antenna_m.z + d * bearing.cos, grid.z0_m, tiles.tiles_z());
  // Inwards: seen from above, far ground stands higher than near ground, so the first tiles set a horizon
  // that most others lie below.
  while (d > from_m && ti >= 0 && tj >= 0 && ti < tiles.tiles_x() && tj < tiles.tiles_z()) {
    const double x = grid.x0_m + (bearing.sin > 0 ? ti : ti + 1) * tile_m;
    const double z = grid.z0_m + (bearing.cos > 0 ? tj : tj + 1) * tile_m;
    const double to_x = bearing.sin != 0 ? (x - antenna_m.x) / bearing.sin : -HUGE_VAL;
    const double to_z = bearing.cos != 0 ? (z - antenna_m.z) / bearing.cos : -HUGE_VAL;
    const double next = std::clamp(std::max(to_x, to_z), from_m, d);
    const double highest = static_cast<double>(tiles.tile(ti, tj).highest_m) - antenna_m.y;
    // No point of the tile stands above `highest` at the distance that suits it best. Points on the tile's
    // border may round into the next cell, which shares the border's nodes.
    if (std::isfinite(highest) && !horizon.hides(highest > 0 ? next : d, highest)) {
      GroundWalk walk(grid, antenna_m, bearing.sin, bearing.cos, next, d);
      RaiseByGround raise{horizon, antenna_m.y};
      walk.advance(d, raise);
    }
    if (to_x > to_z) {
      ti += bearing.sin > 0 ? -1 : 1;
    } else {
      tj += bearing.cos > 0 ? -1 : 1;
    }
    d = next;
  }
  return horizon;
}

}  // namespace obliq
