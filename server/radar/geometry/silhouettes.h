#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/geometry/sector.h"
#include "terrain/buildings/buildings.h"

namespace obliq {

/// Where the antenna sees a building: it lies between these ground distances and bearings (offsets clockwise
/// from the sector's centre), and no part of it stands above the slope.
struct BuildingBounds {
  std::uint32_t building = 0;
  double near_m = 0;
  double far_m = 0;
  double from_rad = 0;
  double to_rad = 0;     ///< from_rad < to_rad; may lie beyond half a turn, so that the two never wrap
  double top_slope = 0;  ///< height over ground distance
};

/// Bounds for a fraction of what the silhouette costs, as cheap as a look-up.
BuildingBounds bounds_of(const Buildings& buildings, const Sector& sector, std::uint32_t building);

/// The exact bounds of the outline, but for rounding, and its corners.
struct Silhouette : BuildingBounds {
  std::vector<double> corners_rad;  ///< between walls of which at least one faces the antenna, rising;
                                    ///< all of a building around the antenna
};

constexpr int kASilhouette = 200;  ///< to find one, in units of ask()

/// The building's silhouette around the turn that its first corner is in. A building that surrounds the
/// antenna or stands under it reaches from -pi to pi with near_m 0.
Silhouette silhouette_of(const Buildings& buildings, const Sector& sector, std::uint32_t building);

}  // namespace obliq
