#pragma once
#include <vector>

#include "server/radar/geometry/sector_extent.h"
#include "server/radar/simd/exact_math.h"
#include "terrain/frames.h"

namespace obliq {

/// Row edges and ray elevations of the polar frustum, from the nearest row to the highest. Radians.
struct PolarRows {
  std::vector<double> edge_rad;  ///< [rows + 1], rising
  std::vector<SinCos> edge;      ///< of edge_rad
  std::vector<SinCos> ray;       ///< [rows], of the rays' elevations, inside their rows
  int ground_rows = 0;           ///< how many of them step evenly in slant range; the rest step in elevation
};

/// Rows for a sector. Up to the farther of r_max and the horizon they step evenly in slant range over the
/// effective earth's sphere at the sector's median height, so that every range bin gets the same number; from
/// there to the highest post or roof they step evenly in elevation, in a share that gives a 30-degree slope
/// at r_max the same range step, at most half of all rows. An antenna below the median height steps in
/// elevation throughout.
PolarRows polar_rows(const Sector& sector, const SectorExtent& extent, const SectorBox& box,
                     const WorldFrame& frame, int rows);

}  // namespace obliq
