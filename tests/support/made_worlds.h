#pragma once
// Worlds made by hand: heights from a function, prisms from corners, an antenna at any world point. Flat
// earth; no files.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "server/radar/geometry/pose.h"
#include "terrain/base/units.h"
#include "terrain/buildings/extrude.h"
#include "terrain/world.h"

namespace obliq::test {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Nodes at multiples of cell_m within half_m of the origin; height_m(x, z), NaN for no ground.
inline World made_world(double half_m, double cell_m, const std::function<double(double, double)>& height_m) {
  World world;
  world.frame = WorldFrame(33.0 * kDegree_rad, -99.5 * kDegree_rad, std::numeric_limits<double>::infinity());
  HeightGrid& grid = world.grid;
  const int half = static_cast<int>(half_m / cell_m);
  grid.cell_m = cell_m;
  grid.x0_m = grid.z0_m = -half * cell_m;
  grid.nx = grid.nz = 2 * half + 1;
  for (int j = 0; j < grid.nz; ++j)
    for (int i = 0; i < grid.nx; ++i)
      grid.y_m.push_back(static_cast<float>(height_m(grid.node_x_m(i), grid.node_z_m(j))));
  return world;
}

/// A prism over corners in world (x, z), its roof height_m above the mean ground at its corners.
inline void add_prism(World& world, const Ring& corners, double height_m, std::uint8_t material = 1) {
  OutlineShaper shaper;
  const ShapedOutline shaped = shaper.shape(Polygon{{corners}});
  if (shaped.parts.size() != 1) throw std::runtime_error("the outline is not one piece");
  const Footing footing = footing_of(world.grid, shaped.parts[0]);
  if (footing.state != Footing::State::good) throw std::runtime_error("no ground under the outline");
  append_prism(world.buildings, shaped.parts[0], footing,
               {height_m, material, world.buildings.list.size() + 1000});
}

/// Corners of a rectangle around (x, z).
inline Ring rectangle(double x_m, double z_m, double width_m, double length_m) {
  const double a = width_m / 2, b = length_m / 2;
  return {{x_m - a, z_m - b}, {x_m + a, z_m - b}, {x_m + a, z_m + b}, {x_m - a, z_m + b}};
}

/// Corners of an ellipse around the origin, of axes a and b.
inline Ring ellipse(double a_m, double b_m, int corners) {
  constexpr double kPi = std::numbers::pi;
  Ring ring;
  for (int k = 0; k < corners; ++k)
    ring.emplace_back(a_m / 2 * std::cos(2 * kPi * k / corners), b_m / 2 * std::sin(2 * kPi * k / corners));
  return ring;
}

/// An antenna at a world point, its sector centred on a world bearing.
inline Pose pose_at(const World& world, const glm::dvec3& antenna_m, double bearing_deg) {
  Pose pose;
  pose.antenna.m = antenna_m;
  const Geodetic at = world.frame.geodetic_from_world(pose.antenna);
  pose.settings.latitude_deg = at.latitude_rad / kDegree_rad;
  pose.settings.longitude_deg = at.longitude_rad / kDegree_rad;
  pose.settings.height_m = at.height_m;
  pose.north_rad = world.frame.north_rad(at);
  pose.bearing_world_rad = bearing_deg * kDegree_rad;
  pose.settings.bearing_deg = bearing_deg - pose.north_rad / kDegree_rad;
  pose.ground_y_m = world.grid.height_at_m(antenna_m.x, antenna_m.z);
  return pose;
}

}  // namespace obliq::test
