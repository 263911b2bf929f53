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

  /// One that overlaps an azimuth bin; its bearings and by_rad are offsets from the sector's centre.
  struct Seen {
    std::uint32_t number;
    double by_rad;
  };
  /// By distance.
  std::span<const Seen> in(int azimuth_bin) const { return bins_[static_cast<std::size_t>(azimuth_bin)]; }
  const Silhouette& silhouette(const Seen& seen) const { return near_[seen.number]; }

 private:
  void sort_into(const BinGrid& bins);

  std::vector<Silhouette> near_;         // by distance
  std::vector<std::uint32_t> numbers_;   // of buildings, rising
  std::vector<std::vector<Seen>> bins_;  // [n_azimuth]
};

}  // namespace obliq
