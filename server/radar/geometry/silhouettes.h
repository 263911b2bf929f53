#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/geometry/sector.h"
#include "terrain/buildings/buildings.h"

namespace obliq {

/// Bearings under which the antenna sees a building, offsets clockwise from the sector's centre.
struct Silhouette {
  std::uint32_t building = 0;
  double near_m = 0;  ///< nothing of the building is nearer (ground distance)
  double far_m = 0;   ///< nor farther
  double from_rad = 0;
  double to_rad = 0;  ///< from_rad < to_rad; may lie beyond half a turn, so that the two never wrap
  std::vector<double> corners_rad;  ///< between walls of which at least one faces the antenna, rising;
                                    ///< all of a building around the antenna
};

/// Bounds of a building's bearings and of its distance, for a fraction of what the silhouette costs.
struct RoughBearings {
  double near_m;    ///< nothing is nearer
  double far_m;     ///< nor farther
  double from_rad;  ///< it lies between these, as in Silhouette
  double to_rad;
};
RoughBearings rough_bearings_of(const Buildings& buildings, const Sector& sector, std::uint32_t building);

/// The building's silhouette around the turn that its first corner is in. A building that surrounds the
/// antenna or stands under it reaches from -pi to pi with near_m 0.
Silhouette silhouette_of(const Buildings& buildings, const Sector& sector, std::uint32_t building);

}  // namespace obliq
