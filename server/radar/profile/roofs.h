#pragma once
// Roofs over a vertical profile.
#include <algorithm>
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

/// The line of a wall on a map, from a point: how far off it is (negative behind it) and its unit normal
/// outwards.
struct WallLine {
  double distance_m;
  double normal_x;
  double normal_z;
};
WallLine wall_line(const Buildings& buildings, std::uint32_t building, std::uint32_t wall, double x_m,
                   double z_m);

/// And the ground distances of its nearest and its farthest point.
struct WallPlane : WallLine {
  double nearest_m;
  double farthest_m;
};
WallPlane wall_plane(const Buildings& buildings, std::uint32_t building, std::uint32_t wall, double x_m,
                     double z_m);
inline WallPlane wall_plane(const Buildings& buildings, std::uint32_t wall, double x_m, double z_m) {
  return wall_plane(buildings, buildings.building_of_face[wall], wall, x_m, z_m);
}

/// Appends the stretches of the half-line from (x, z) along (sin, cos) that lie inside a building's
/// footprint, from distance 0 on, unsorted.
void add_roof_spans(const Buildings& buildings, std::uint32_t building_index, double x_m, double z_m,
                    double sin_bearing, double cos_bearing, std::vector<RoofSpan>& spans);

/// The highest roof wherever spans overlap, by distance. `spans` is sorted on the way. A span from one corner
/// to the same, without extent, may be among them.
std::vector<RoofSpan> disjoint_roofs(std::vector<RoofSpan>& spans);

/// Cuts a stretch of a profile at the edges of disjoint, sorted roofs: calls open(d0, d1) for what lies under
/// none, and roofed(span, d0, d1), outwards. `at`: the first roof that may end beyond d0; it goes along.
template <class Open, class Roofed>
void cut_at_roofs(const std::vector<RoofSpan>& roofs, std::size_t& at, double d0, double d1, const Open& open,
                  const Roofed& roofed) {
  while (d0 < d1) {
    while (at < roofs.size() && roofs[at].far_m <= d0) ++at;
    const bool under = at < roofs.size() && roofs[at].near_m <= d0;
    double end = d1;
    if (at < roofs.size()) end = std::min(d1, under ? roofs[at].far_m : roofs[at].near_m);
    if (under) {
      roofed(roofs[at], d0, end);
    } else {
      open(d0, end);
    }
    d0 = end;
  }
}

/// The higher of ground y = start_m + rise d and a roof: calls ground(d0, d1) and roof(d0, d1), outwards.
template <class Ground, class Roof>
void over_roof(double start_m, double rise, double roof_y_m, double d0, double d1, const Ground& ground,
               const Roof& roof) {
  const bool above0 = start_m + rise * d0 - roof_y_m > 0;
  const bool above1 = start_m + rise * d1 - roof_y_m > 0;
  if (above0 == above1) return above0 ? ground(d0, d1) : roof(d0, d1);
  const double cut = std::clamp((roof_y_m - start_m) / rise, d0, d1);
  if (above0) {
    ground(d0, cut);
    roof(cut, d1);
  } else {
    roof(d0, cut);
    ground(cut, d1);
  }
}

/// World y of the highest roof above a point that lies inside a building's solid; nothing outside.
std::optional<double> roof_above(const Buildings& buildings, const glm::dvec3& point_m);

}  // namespace obliq
