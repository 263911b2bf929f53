#pragma once
// Roofs over a vertical profile.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "server/scene/exact_hit.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq {

/// A stretch of a profile over a building's footprint: inside between two ground distances.
struct RoofSpan {
  double near_m;
  double far_m;
  double roof_y_m;
  std::uint32_t building;
  std::uint32_t wall;  ///< face through which the profile enters at near_m; kNoFace: none
};

/// Appends the stretches of the half-line from (x, z) along (sin, cos) that lie inside a building's
/// footprint, from distance 0 on, unsorted.
void add_roof_spans(const Buildings& buildings, std::uint32_t building_index, double x_m, double z_m,
                    double sin_bearing, double cos_bearing, std::vector<RoofSpan>& spans);

/// The highest roof wherever spans overlap, by distance. `spans` is sorted on the way. A span from one corner
/// to the same, without extent, may be among them.
std::vector<RoofSpan> disjoint_roofs(std::vector<RoofSpan>& spans);

/// World y of the highest roof above a point that lies inside a building's solid; nothing outside.
std::optional<double> roof_above(const Buildings& buildings, const glm::dvec3& point_m);

}  // namespace obliq
