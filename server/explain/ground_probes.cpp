#include "server/explain/ground_probes.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

constexpr int kDistances = 512;  ///< along each azimuth, evenly from under the antenna to r_max

}  // namespace

GroundProbes::GroundProbes(const FramePlan& plan, const std::vector<AzimuthRange>& wedges) {
  const HeightGrid& grid = plan.scene().world().grid;
  const Sector& sector = plan.sector();
  for (const AzimuthRange& wedge : wedges) {
    for (int bin = wedge.first; bin < wedge.first + wedge.count; ++bin) {
      const double bearing = plan.bearing_rad(bin + 0.5);
      for (int n = 1; n <= kDistances; ++n) {
        const double ground_m = sector.r_max_m * n / kDistances;
        const double x = sector.antenna_m.x + ground_m * std::sin(bearing);
        const double z = sector.antenna_m.z + ground_m * std::cos(bearing);
        const double below = sector.antenna_m.y - grid.height_at_m(x, z);
        const double slant = std::hypot(ground_m, below);
        if (slant >= sector.r_min_m && slant <= sector.r_max_m) points_.push_back({x, z, below, slant});
      }
    }
  }
}

GroundShift GroundProbes::shift_in(const World& world, const Pose& pose) const {
  GroundShift shift;
  const glm::dvec3& antenna = pose.antenna.m;
  for (const Point& p : points_) {
    const double below = antenna.y - world.grid.height_at_m(p.x_m, p.z_m);
    if (std::isnan(below)) continue;
    const double ground_m = std::hypot(p.x_m - antenna.x, p.z_m - antenna.z);
    shift.slant_m = std::max(shift.slant_m, std::abs(std::hypot(ground_m, below) - p.slant_m));
    shift.vertical_m = std::max(shift.vertical_m, std::abs(below - p.below_antenna_m));
  }
  return shift;
}

}  // namespace obliq
