#include "server/radar/geometry/range_steps.h"

#include <cmath>

namespace obliq {
namespace {

/// Slant range at which the edge line above row `row` (0 = the top edge) meets ground below_m under the
/// antenna.
double range_of_edge_m(const PerspectiveFrustum& frustum, double row, double below_m) {
  const glm::dvec3 d = frustum.direction((frustum.columns - 1) / 2.0, row - 0.5);
  return below_m * std::hypot(d.y, d.z) / -d.y;
}

}  // namespace

StepSizes slant_range_steps(const PerspectiveFrustum& frustum, double below_m) {
  const double rows = frustum.rows;
  return {range_of_edge_m(frustum, 0, below_m) - range_of_edge_m(frustum, 1, below_m),
          range_of_edge_m(frustum, rows - 1, below_m) - range_of_edge_m(frustum, rows, below_m)};
}

StepSizes flat_steps(FrustumKind kind, double height_m, double r_min_m, double r_max_m, int pixels) {
  const SectorBox box(height_m, 0, r_min_m, r_max_m, 0);
  return slant_range_steps(kind == FrustumKind::symmetric ? symmetric_frustum(box, 0, pixels, pixels)
                                                          : oblique_frustum(box, pixels, pixels),
                           height_m);
}

}  // namespace obliq
