#pragma once
#include "server/radar/geometry/sector.h"
#include "server/scene/scene.h"

namespace obliq {

/// Heights of the known posts and the roofs that lie in the sector and swath, widened by 1.5 cells so that
/// every triangle that reaches into the swath is bounded. World y.
struct SectorExtent {
  bool any = false;            ///< false: no known ground in the sector; nothing else is meaningful
  double bottom_y_m = 0;       ///< y_tb
  double top_y_m = 0;          ///< y_tb + W_y
  double median_height_m = 0;  ///< above the datum, over one post per 32 x 32 cells
  double highest_elevation_rad = 0;
};

SectorExtent measure_sector(const Scene& scene, const Sector& sector);

}  // namespace obliq
