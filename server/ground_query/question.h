#pragma once
// What a ground query asks, checked before anything is worked out.
#include <optional>
#include <vector>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq {

struct GroundQuestion {
  /// The places [n]: latitudes and longitudes, or bearings (true, at the antenna) and slant ranges from the
  /// antenna to the ground.
  std::vector<double> latitude_deg, longitude_deg;
  std::vector<double> bearing_deg, range_m;
  /// Of the points that are seen or not: [n], or one for all; none: on the ground.
  std::vector<double> height_m;
  HeightReference height_reference = HeightReference::datum;
  double geoid_undulation_m = 0;
  std::optional<PoseSettings> antenna;  ///< nothing: no sight is asked for

  bool by_bearing() const { return !bearing_deg.empty() || !range_m.empty(); }
  std::size_t points() const { return by_bearing() ? bearing_deg.size() : latitude_deg.size(); }
};

/// What cannot be answered: numbers out of their limits, columns of different lengths. One of each kind.
std::vector<FieldError> faults_of(const GroundQuestion& question);

}  // namespace obliq
