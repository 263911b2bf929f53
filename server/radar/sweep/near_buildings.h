#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// The slope (height above the antenna over ground distance) that all surface in the swath stands above: what
/// lies lower is nearer, and hides nothing in the swath.
double lowest_slope_in_swath(const ScenePlan& plan);

/// The buildings of a frame that stand so near to the antenna, for their height, that sub-columns would be
/// too coarse (NearView), wherever the swath ends. Immutable.
class NearBuildings {
 public:
  explicit NearBuildings(const ScenePlan& plan);

  bool empty() const { return near_.empty(); }
  bool has(std::uint32_t building) const;
  /// Those that overlap an azimuth bin, by distance.
  std::vector<Silhouette> in(int azimuth_bin) const;

 private:
  BinGrid bins_;
  std::vector<Silhouette> near_;        // by distance
  std::vector<std::uint32_t> numbers_;  // rising
};

}  // namespace obliq
