#include "server/explain/variants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace obliq {

namespace {

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// By the shoelace formula; holes count as built over.
double outline_area_m2(const Buildings& buildings, const Building& building) {
  const std::uint32_t begin = buildings.ring_start[building.first_ring];
  const std::uint32_t end = buildings.ring_start[building.first_ring + 1];
  double doubled = 0;
  for (std::uint32_t k = begin; k < end; ++k) {
    // Differences from the first corner, since the outline is far smaller than its distance from the origin.
    const glm::dvec2 a(buildings.ring_xz_m[k] - buildings.ring_xz_m[begin]);
    const glm::dvec2 b(buildings.ring_xz_m[k + 1 < end ? k + 1 : begin] - buildings.ring_xz_m[begin]);
    doubled += a.x * b.y - b.x * a.y;
  }
  return std::abs(doubled) / 2;
}

constexpr int kDistances = 512;  ///< along each azimuth, evenly from under the antenna to r_max

}  // namespace

std::vector<std::uint8_t> materials_used(const World& world) {
  std::array<bool, 256> used{};
  for (const std::uint8_t id : world.surface_material) used[id] = true;
  for (const Building& building : world.buildings.list) used[building.material] = true;
  std::vector<std::uint8_t> ids;
  for (std::size_t id = 1; id < used.size(); ++id)
    if (used[id]) ids.push_back(static_cast<std::uint8_t>(id));
  return ids;
}

BuildingSizes median_sizes(const Buildings& buildings) {
  std::vector<double> heights_m, sides_m;
  for (const Building& building : buildings.list) {
    sides_m.push_back(std::sqrt(outline_area_m2(buildings, building)));
    // A wall's centre is half-way up what stands out of the ground.
    for (std::uint32_t f = building.first_face; f < building.first_face + building.n_faces; ++f) {
      if (!buildings.faces[f].wall) continue;
      heights_m.push_back(2 * (static_cast<double>(building.roof_y_m) - buildings.faces[f].centre_m.y));
      break;
    }
  }
  return {median(heights_m), median(sides_m)};
}

GroundProbes::GroundProbes(const FramePlan& plan, const std::vector<AzimuthRange>& wedges) {
  const HeightGrid& grid = plan.scene().world().grid;
  const Sector& sector = plan.sector();
  for (const AzimuthRange& wedge : wedges) {
    for (int bin = wedge.first; bin < wedge.first + wedge.count; ++bin) {
      const double bearing = sector.bearing_rad + plan.bins().azimuth_edge_rad(bin + 0.5);
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
