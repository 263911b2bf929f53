#include "server/ground_query/place_at_range.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/ground_walk.h"
#include "server/scene/tolerances.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Looks for the first ground that is so far away, outwards.
struct FindRange {
  double antenna_y_m;
  double range_m;
  double found_m = -1;
  bool too_near = false, gap_met = false, begun = false;

  void ground(const GroundSegment& segment) {
    const double start = segment.start_m - antenna_y_m;
    const auto range2 = [&](double d) {
      const double h = start + segment.rise * d;
      return d * d + h * h;
    };
    const double wanted2 = range_m * range_m;
    if (!begun && range2(segment.d0_m) > wanted2) too_near = true;
    begun = true;
    if (enough() || range2(segment.d1_m) < wanted2) return;
    // d^2 + (start + rise d)^2 = range^2, the greater root: range grows there.
    const double a = 1 + segment.rise * segment.rise;
    const double b = start * segment.rise;
    const double c = start * start - wanted2;
    found_m = std::clamp((std::sqrt(std::max(0.0, b * b - a * c)) - b) / a, segment.d0_m, segment.d1_m);
  }
  void gap(double from_m, double to_m) {
    if (!enough() && to_m - from_m > kMargin_m) gap_met = true;
  }
  bool enough() const { return found_m >= 0 || too_near || gap_met; }
};

}  // namespace

PlaceAtRange place_at_range(const Scene& scene, const Pose& antenna, double bearing_deg, double range_m) {
  const HeightGrid& grid = scene.world().grid;
  const glm::dvec3& at = antenna.antenna.m;
  const double bearing = std::remainder(bearing_deg, 360.0) * kDegree_rad + antenna.north_rad;
  const double sin = std::sin(bearing), cos = std::cos(bearing);
  // No ground is higher or lower over the antenna than this, so none nearer can be so far away.
  const double most_m =
      std::max(std::abs(scene.tiles().highest_m() - at.y), std::abs(scene.tiles().lowest_m() - at.y));
  const double from_m =
      most_m < range_m ? std::sqrt((range_m - most_m) * (range_m + most_m)) * (1 - 1e-12) - kMargin_m : 0;
  const double first_m = std::max(0.0, from_m);
  GroundWalk walk(grid, at, sin, cos, first_m, range_m + kMargin_m);
  if (walk.done() || walk.at_m() > first_m + kMargin_m) return {wire::GroundState::outside, {}};
  FindRange find{at.y, range_m};
  walk.advance(range_m + kMargin_m, find);
  if (find.too_near) return {wire::GroundState::too_near, {}};
  if (find.gap_met) return {wire::GroundState::unknown, {}};
  if (find.found_m < 0) return {wire::GroundState::outside, {}};
  const double x = at.x + find.found_m * sin, z = at.z + find.found_m * cos;
  const double y = grid.height_at_m(x, z);
  if (std::isnan(y)) return {wire::GroundState::unknown, {}};  // rounded across the edge of a void
  return {wire::GroundState::known, {glm::dvec3(x, y, z)}};
}

}  // namespace obliq
