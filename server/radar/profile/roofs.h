#pragma once
// Footprints of buildings in the plane: point tests and crossings with a vertical azimuth plane.
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "terrain/buildings/buildings.h"

namespace obliq {

/// One crossing of a ray in the plane with a footprint: inside between near_m and far_m (ground distances).
struct FootprintSpan {
  double near_m;
  double far_m;
  double roof_y_m;
  std::uint32_t building;
  std::uint32_t wall;  ///< face crossed at near_m; meaningless when the half-line starts inside
};

/// World y of the highest roof above a point that lies inside a building's solid; nothing outside.
std::optional<double> roof_above(const Buildings& buildings, const glm::dvec3& point_m);

/// Appends the stretches of the half-line from (x, z) along (sin, cos) that lie inside a building's
/// footprint, unsorted, from distance 0 on.
void footprint_spans(const Buildings& buildings, std::uint32_t building_index, double x_m, double z_m,
                     double sin_bearing, double cos_bearing, std::vector<FootprintSpan>& spans);

}  // namespace obliq
