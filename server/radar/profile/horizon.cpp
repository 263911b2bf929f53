#include "server/radar/profile/horizon.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/tile_walk.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// A horizon, without its tiles, in units of ask().
constexpr std::int64_t kALook = 50;
constexpr std::int64_t kATile = 8;

/// Raises a horizon by every corner of the ground's profile; a straight segment is highest at one of its
/// ends.
struct RaiseByGround {
  Horizon<double>& horizon;
  double antenna_y_m;

  void ground(const GroundSegment& segment) {
    horizon.raise(segment.d0_m, segment.start_m + segment.rise * segment.d0_m - antenna_y_m, false);
    horizon.raise(segment.d1_m, segment.start_m + segment.rise * segment.d1_m - antenna_y_m, false);
  }
  static void gap(double, double) {}
  static bool enough() { return false; }
};

/// Looks along one profile, inwards: seen from above, far ground stands higher than near ground, so the first
/// tiles set a horizon that most others lie below.
class InwardLook {
 public:
  InwardLook(const Scene& scene, const HorizonBound& ridge, const glm::dvec3& antenna_m, SinCos bearing,
             double end_m)
      : scene_(scene),
        ridge_(ridge),
        grid_(scene.world().grid),
        antenna_m_(antenna_m),
        bearing_(bearing),
        per_x_(1 / bearing.sin),
        per_z_(1 / bearing.cos),
        end_m_(end_m),
        ground_(ground_view(grid_, antenna_m)) {}

  const Horizon<double>& horizon() const { return horizon_; }

  /// Raises the horizon by the ground between two distances, tile by tile.
  void look(const TileBounds& tiles, double from_m, double to_m) {
    const double tile_m = tiles.cells() * grid_.cell_m;
    double d = to_m;
    int ti = tile_of(antenna_m_.x + d * bearing_.sin, grid_.x0_m, tile_m, tiles.tiles_x());
    int tj = tile_of(antenna_m_.z + d * bearing_.cos, grid_.z0_m, tile_m, tiles.tiles_z());
    while (d > from_m && ti >= 0 && tj >= 0 && ti < tiles.tiles_x() && tj < tiles.tiles_z() &&
           !ridge_.hidden_by(horizon_, d)) {
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
        } else if (tiles.tile(ti, tj).whole) {
          const HorizonPoint found =
              active_kernels().highest_ground(ground_, {bearing_.sin, bearing_.cos, next, d});
          horizon_.raise(found.d_m, found.h_m, false);
          if (d == end_m_) raise_at_end();
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
  /// The far end need not lie on an edge of the mesh.
  void raise_at_end() {
    const double y =
        grid_.height_at_m(antenna_m_.x + end_m_ * bearing_.sin, antenna_m_.z + end_m_ * bearing_.cos);
    if (!std::isnan(y)) horizon_.raise(end_m_, y - antenna_m_.y, false);
  }

  const Scene& scene_;
  const HorizonBound& ridge_;
  const HeightGrid& grid_;
  const glm::dvec3& antenna_m_;
  SinCos bearing_;
  double per_x_;
  double per_z_;
  double end_m_;
  GroundView ground_;
  Horizon<double> horizon_;
};

}  // namespace

HorizonBound::HorizonBound(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing,
                           double half_width_rad, double to_m) {
  const HeightGrid& grid = scene.world().grid;
  const TileBounds& tiles = scene.tiles();
  const double tile_m = tiles.cells() * grid.cell_m;
  const double step_m = tile_m / 2;
  steps_per_m_ = 1 / step_m;
  double highest_slope = -HUGE_VAL;
  for (double from = 0; from <= to_m; from += step_m) {
    const double to = from + step_m;
    // The rectangle around what the profiles cross between the two distances.
    const double aside = to * half_width_rad + grid.cell_m;
    const double x0 = antenna_m.x + from * bearing.sin, x1 = antenna_m.x + to * bearing.sin;
    const double z0 = antenna_m.z + from * bearing.cos, z1 = antenna_m.z + to * bearing.cos;
    const int ti1 = tile_of(std::max(x0, x1) + aside, grid.x0_m, tile_m, tiles.tiles_x());
    const int tj1 = tile_of(std::max(z0, z1) + aside, grid.z0_m, tile_m, tiles.tiles_z());
    double highest = -HUGE_VAL;
    for (int tj = tile_of(std::min(z0, z1) - aside, grid.z0_m, tile_m, tiles.tiles_z()); tj <= tj1; ++tj)
      for (int ti = tile_of(std::min(x0, x1) - aside, grid.x0_m, tile_m, tiles.tiles_x()); ti <= ti1; ++ti)
        highest = std::max(highest, static_cast<double>(tiles.tile(ti, tj).highest_m));
    ask(kATile);
    const double above_m = highest - antenna_m.y;
    highest_slope = std::max(highest_slope, above_m / (above_m > 0 ? from : to));
    slope_.push_back(highest_slope);
  }
}

Horizon<double> ground_horizon(const Scene& scene, const HorizonBound& ridge, const glm::dvec3& antenna_m,
                               SinCos bearing, double to_m) {
  const GroundWalk whole(scene.world().grid, antenna_m, bearing.sin, bearing.cos, 0, to_m);
  if (whole.done()) return {};
  const double end_m = std::min(to_m, whole.end_m());
  InwardLook inwards(scene, ridge, antenna_m, bearing, end_m);
  inwards.look(scene.tiles(), whole.at_m(), end_m);
  ask(kALook + static_cast<std::int64_t>((end_m - whole.at_m()) /
                                         (scene.fine_tiles().cells() * scene.world().grid.cell_m)));
  return inwards.horizon();
}

}  // namespace obliq
