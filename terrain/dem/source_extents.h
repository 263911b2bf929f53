#pragma once
// Where the elevation models of a scene can have ground: for answers that must be quick, so each file is
// taken as a rectangle of longitude and latitude. Inside it there may be voids; outside there is no data.
#include <span>
#include <string>
#include <vector>

#include "terrain/world_spec.h"

namespace obliq {

class SourceExtents {
 public:
  /// Made-up ground: everywhere.
  SourceExtents() = default;
  /// One rectangle a file, around the points of its edge.
  explicit SourceExtents(std::string what) : what_(std::move(what)), everywhere_(false) {}
  void add(std::span<const LonLat> edge);
  /// Leaves nothing beyond the rectangle around a polygon.
  void cut_to(std::span<const LonLat> polygon);

  bool covers(const LonLat& place) const;
  /// Whether there is anything within so far of the place.
  bool reaches(const LonLat& place, double radius_m) const;
  /// The part of that disc that is covered, 0 to 1, to a hundredth or so.
  double share(const LonLat& place, double radius_m) const;
  /// "terrain.dem covers longitude -105.1000 to -104.9000, latitude 39.9000 to 40.1000"
  std::string text() const;

 private:
  struct Box {
    double middle_deg = 0;  ///< longitude
    double half_deg = 0;    ///< of its width
    double south_deg = 90;
    double north_deg = -90;

    static Box around(std::span<const LonLat> points);
    bool holds(const LonLat& place) const;
    LonLat nearest(const LonLat& place) const;
  };
  std::string what_;
  bool everywhere_ = true;
  std::vector<Box> boxes_;
};

/// Opens the elevation models, without reading heights. Throws InputError.
SourceExtents source_extents(const TerrainSpec& terrain);

}  // namespace obliq
