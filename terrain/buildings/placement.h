#pragma once
// Where things given by longitude and latitude stand on the loaded ground.
#include "terrain/buildings/vector_source.h"
#include "terrain/polygon.h"
#include "terrain/world.h"

namespace obliq {

enum class GroundState { known, unknown, off_grid };

/// A place on the loaded ground.
struct GroundPlace {
  GroundState state = GroundState::off_grid;
  WorldPoint point;
  double height_m = 0;  ///< above the datum; 0 where no ground is known
};

/// Finds the ground's own height at the position: the plumb line leans against world y (17 m at 37 km for
/// 3 km of relief), so the place depends on the height and the height on the place.
GroundPlace place_on_ground(const World& world, const LonLat& position);

/// World polygon of a polygon whose points all have one height above the datum.
Polygon world_polygon(const WorldFrame& frame, const GeoPolygon& polygon, double height_m);

/// South-west and north-east corners of the grid in degrees, a little larger than the grid. Longitudes run on
/// from the origin's.
struct GeoWindow {
  LonLat south_west;
  LonLat north_east;
};
GeoWindow geo_window(const World& world);

}  // namespace obliq
