#pragma once
#include <GeographicLib/AzimuthalEquidistant.hpp>
#include <glm/vec3.hpp>

#include "terrain/frames.h"

namespace obliq::wire {
class FrameDescriptor;
}

namespace obliq {

/// A frame's sector as bearings and slant ranges.
struct MapSector {
  double start_rad = 0;  ///< true bearing of its left edge
  double width_rad = 0;
  double r_min_m = 0;
  double r_max_m = 0;
  bool all_round() const { return width_rad > 6.28; }
};

/// Between the map's plane (azimuthal equidistant metres east and north of the antenna) and what a radar
/// measures. Both ways go through the world frame that the bins were made in, so that rings, outline and
/// pixels of a picture agree wherever the radar stands.
class MapProjection {
 public:
  /// A descriptor may come from any server: throws InputError for one that no map can be made of.
  explicit MapProjection(const wire::FrameDescriptor& descriptor);

  struct Place {
    double east_m = 0;
    double north_m = 0;
  };

  /// World offset from the antenna of a place at the reference height, and so much above it.
  glm::dvec3 offset(Place place, double above_reference_m = 0) const;
  /// Where a bearing meets the reference height at a slant range; below the antenna where it does not reach
  /// down so far.
  Place place(double bearing_rad, double slant_m) const;

  const MapSector& sector() const { return sector_; }
  double north_rad() const { return north_rad_; }
  glm::dvec3 antenna_m() const { return antenna_m_; }
  double antenna_above_m() const { return antenna_above_m_; }

 private:
  WorldFrame frame_;
  GeographicLib::AzimuthalEquidistant plane_;
  double latitude_deg_;
  double longitude_deg_;
  double reference_m_;
  double north_rad_;
  glm::dvec3 antenna_m_;
  MapSector sector_;
  double antenna_above_m_;
};

}  // namespace obliq
