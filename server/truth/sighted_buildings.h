#pragma once
// Which buildings stand in which azimuth bin, and where a vertical plane crosses their outlines.
#include <cstdint>
#include <vector>

#include "server/truth/reference.h"

namespace obliq {

/// A vertical half-plane from the antenna outwards.
struct AzimuthPlane {
  long double sin_bearing;
  long double cos_bearing;
};

/// A plane enters or leaves a footprint.
struct OutlineCrossing {
  long double d_m;            ///< ground distance, > 0
  double cos_to_plane;        ///< |n . e|: of the wall's horizontal normal and the plane's direction
  double normal_x, normal_z;  ///< of the wall: unit, towards the antenna
  std::size_t owner;          ///< as given to cross()
};

/// Buildings by azimuth bin. Immutable.
class SightedBuildings {
 public:
  SightedBuildings(const Buildings& buildings, const ReferenceView& view, int first_azimuth, int n_azimuth);

  /// Indices of the buildings that reach into an azimuth bin within r_max, rising.
  const std::vector<std::uint32_t>& in_bin(int azimuth) const {
    return by_bin_[static_cast<std::size_t>(azimuth - first_azimuth_)];
  }

  /// Bearings clockwise from the sector's start, in radians, of the corners inside an azimuth bin of the
  /// buildings in it, rising. In between them the planes cross the same walls.
  std::vector<double> corner_bearings_rad(int azimuth) const;

  /// Appends the plane's crossings with one building's outline, unsorted. Returns whether the antenna's own
  /// position is inside the outline (even-odd rule).
  bool cross(std::uint32_t building, const AzimuthPlane& plane, std::size_t owner,
             std::vector<OutlineCrossing>& crossings) const;

 private:
  void sort_in(std::uint32_t building);
  double from_start_rad(double bearing_rad) const;

  const Buildings& buildings_;
  const ReferenceView view_;
  glm::dvec3 antenna_m_;
  int first_azimuth_;
  std::vector<std::vector<std::uint32_t>> by_bin_;
};

}  // namespace obliq
