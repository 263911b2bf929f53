#include "server/radar/visibility/coverage.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/tile_walk.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// The ground area of an azimuth bin between two distances, as far as it lies in the swath: between r_min and
/// r_max at the median height.
struct BinArea {
  double width_rad;
  double near_m;
  double far_m;

  explicit BinArea(const FramePlan& plan) : width_rad(plan.bins().azimuth_width_rad) {
    const BinGrid& bins = plan.bins();
    const glm::dvec3& antenna = plan.sector().antenna_m;
    const double clearance = plan.looks_at().extent().any
                                 ? antenna.y - plan.looks_at().extent().median_height_m -
                                       plan.scene().world().frame.datum_y_m(antenna.x, antenna.z)
                                 : 0.0;
    near_m = std::sqrt(std::max(0.0, bins.r_min_m * bins.r_min_m - clearance * clearance));
    far_m = std::sqrt(std::max(0.0, bins.r_max_m * bins.r_max_m - clearance * clearance));
  }
  double ring_m2(double d0, double d1) const {
    const double a = std::clamp(d0, near_m, far_m);
    const double b = std::clamp(d1, near_m, far_m);
    return 0.5 * width_rad * (b - a) * (b + a);
  }
};

constexpr int kAnAzimuth = 50;  // without its tiles, in units of ask()

/// Adds up what a walk finds no ground on.
struct Gaps {
  const BinArea& area;
  double missing_m2 = 0;

  static void ground(const GroundSegment&) {}
  void gap(double d0, double d1) { missing_m2 += area.ring_m2(d0, d1); }
  static bool enough() { return false; }
};

}  // namespace

GroundArea ground_area(const FramePlan& plan, int azimuth_bin) {
  ask(kAnAzimuth);
  const BinArea area(plan);
  const HeightGrid& grid = plan.scene().world().grid;
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const double r_max_m = plan.bins().r_max_m;
  const double bearing_rad = plan.sector().bearing_rad + plan.bins().azimuth_edge_rad(azimuth_bin + 0.5);
  const SinCos bearing{std::sin(bearing_rad), std::cos(bearing_rad)};
  const double sector_m2 = area.ring_m2(area.near_m, area.far_m);
  const GroundWalk whole(grid, antenna, bearing.sin, bearing.cos, 0, r_max_m);
  if (whole.done()) return {sector_m2, 0};
  Gaps gaps{area, area.ring_m2(0, whole.at_m()) + area.ring_m2(whole.end_m(), r_max_m)};
  if (!plan.scene().tiles().whole())
    over_tiles(plan.scene().fine_tiles(), grid, antenna, bearing, whole.at_m(), whole.end_m(),
               [&](const TileBounds::Tile& tile, double d0, double d1) {
                 ask(tile.whole ? 4 : 4 * TileBounds::kFineCells);
                 if (!tile.whole)
                   GroundWalk(grid, antenna, bearing.sin, bearing.cos, d0, d1).advance(d1, gaps);
               });
  return {sector_m2, std::max(0.0, sector_m2 - gaps.missing_m2)};
}

}  // namespace obliq
