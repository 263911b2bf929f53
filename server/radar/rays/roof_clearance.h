#pragma once
#include <span>
#include <vector>

#include "server/radar/geometry/sector.h"
#include "terrain/buildings/buildings.h"

namespace obliq {

/// How high some buildings reach at most, seen from the antenna: tells how far a ray goes before it can meet
/// any of them, whichever way they and it stand.
class RoofLine {
 public:
  RoofLine(const Buildings& all, const Sector& sector, std::span<const std::uint32_t> buildings);

  /// Slant range before which a ray (unit direction) meets none of the buildings; infinite: it meets none at
  /// all.
  double free_range_m(const glm::dvec3& direction) const;

 private:
  struct Roof {
    double near_m;  // ground distance
    double slope;   // the greatest height over ground distance of this one and all before it
  };
  std::vector<Roof> roofs_;  // by distance
};

}  // namespace obliq
