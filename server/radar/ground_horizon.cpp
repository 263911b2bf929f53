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

/// Looks along one plane, inwards: seen from above, far ground stands higher than near ground, so the first
/// tiles set a horizon that most others lie below.
class InwardLook {
 public:
  InwardLook(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing)
      : scene_(scene),
        grid_(scene.world().grid),
        antenna_m_(antenna_m),
        bearing_(bearing),
        per_x_(1 / bearing.sin),
        per_z_(1 / bearing.cos) {}

  const PlaneHorizon& horizon() const { return horizon_; }

  /// Raises the horizon by the ground between two distances, tile by tile.
  void look(const TileBounds& tiles, double from_m, double to_m) {
    const double tile_m = tiles.cells() * grid_.cell_m;
    const auto tile_of = [&](double at, double first, int n) {
      return std::clamp(static_cast<int>(std::floor((at - first) / tile_m)), 0, n - 1);
    };
    double d = to_m;
    int ti = tile_of(antenna_m_.x + d * bearing_.sin, grid_.x0_m, tiles.tiles_x());
    int tj = tile_of(antenna_m_.z + d * bearing_.cos, grid_.z0_m, tiles.tiles_z());
    while (d > from_m && ti >= 0 && tj >= 0 && ti < tiles.tiles_x() && tj < tiles.tiles_z()) {
      const double x = grid_.x0_m + (bearing_.sin > 0 ? ti : ti + 1) * tile_m;
      const double z = grid_.z0_m + (bearing_.cos > 0 ? tj : tj + 1) * tile_m;
      const double to_x = bearing_.sin != 0 ? (x - antenna_m_.x) * per_x_ : -HUGE_VAL;
      const double to_z = bearing_.cos != 0 ? (z - antenna_m_.z) * per_z_ : -HUGE_VAL;
      const double next = std::clamp(std::max(to_x, to_z), from_m, d);
      const double highest = static_cast<double>(tiles.tile(ti, tj).highest_m) - antenna_m_.y;
      // No point of the tile stands above `highest` at the distance that suits it best. Points on the tile's
      // border may round into the next cell, which shares the border's nodes.
      if (std::isfinite(highest) && !horizon_.hides(highest > 0 ? next : d, highest)) {
        if (tiles.cells() > TileBounds::kFineCells) {
          look(scene_.fine_tiles(), next, d);
        } else {
          GroundWalk walk(grid_, antenna_m_, bearing_.sin, bearing_.cos, next, d);
          RaiseByGround raise{horizon_, antenna_m_.y};
          walk.advance(d, raise);
        }
      }
      if (to_x > to_z) {
        ti += bearing_.sin > 0 ? -1 : 1;
      } else {
        tj += bearing_.cos > 0 ? -1 : 1;
      }
      d = next;
    }
  }

 private:
  const Scene& scene_;
  const HeightGrid& grid_;
  const glm::dvec3& antenna_m_;
  SinCos bearing_;
  double per_x_;
  double per_z_;
  PlaneHorizon horizon_;
};

}  // namespace

PlaneHorizon ground_horizon(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing, double to_m) {
  const GroundWalk whole(scene.world().grid, antenna_m, bearing.sin, bearing.cos, 0, to_m);
  if (whole.done()) return {};
  InwardLook inwards(scene, antenna_m, bearing);
  inwards.look(scene.tiles(), whole.at_m(), std::min(to_m, whole.end_m()));
  return inwards.horizon();
}

}  // namespace obliq
