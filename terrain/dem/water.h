#pragma once
// Water that an elevation model itself shows: where it is level, or lies at the height of the sea.
//
// A window of a flight sees only its part of the model. A region counts with what of it lies in the window,
// so a lake of 1 km2 or a bay of 10 km2 that the window cuts may be land in it. The cut is in the margin, out
// of the radars' reach, for as long as the window serves. The same posts give the same water on every
// machine.
#include <cstdint>
#include <vector>

#include "terrain/dem/dem_window.h"

namespace obliq {

/// Regions of exactly equal height are water from this area on: lidar models are "hydro-flattened" so, from 2
/// acres on (USGS Lidar Base Specification, 0.8 ha); this is larger, since plains may be level, too.
constexpr double kLeastLevel_m2 = 1e6;

/// The sea begins at posts of these heights above the datum: models have it at 0, tides and the geoid's error
/// take it a little below.
constexpr double kSeaLowest_m = -1;
constexpr double kSeaHighest_m = 0;
/// It reaches over neighbours that differ by no more, and lie below this.
constexpr double kSeaStep_m = 0.25;
constexpr double kSeaShore_m = 1;
/// It is at least so large, or runs out of the elevation model.
constexpr double kLeastSea_m2 = 10e6;

/// 1 where a post of the window is water: [nz][nx]. posting_m: between the raster's own posts. Level ground
/// is looked for in models with fractions of a unit alone: in whole metres every plain is level. Neither is a
/// terrace water, from which the ground around steps up or down by whole metres: such models were made from
/// whole metres, or contours, and moved to another datum.
std::vector<std::uint8_t> water_posts(const DemWindow& window, double posting_m);

}  // namespace obliq
