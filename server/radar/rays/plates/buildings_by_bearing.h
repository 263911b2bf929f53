#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/profile/local_sight.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// The buildings of one azimuth bin by bearing and distance: which of them a vertical plane through the
/// antenna can meet. A bin may be the whole sector, with thousands of buildings. Immutable.
class BuildingsByBearing {
 public:
  BuildingsByBearing(const ScenePlan& plan, int azimuth_bin);

  /// Appends the roof stretches of the plane along a world direction, those of all buildings that it can meet
  /// between two distances, the nearest building first.
  void add_stretches(double from_m, double to_m, double sin_bearing, double cos_bearing,
                     std::vector<RoofSpan>& stretches) const;

  /// Whether the plane may meet one between two distances.
  bool any_between(double from_m, double to_m, double sin_bearing, double cos_bearing) const;

  /// How many buildings are looked at for a direction, whatever their distance.
  std::size_t candidates(double sin_bearing, double cos_bearing) const {
    return cell(sin_bearing, cos_bearing).buildings.size();
  }

 private:
  /// A stretch of bearings.
  struct Cell {
    std::vector<BuildingBounds> buildings;  // by near_m
    double longest_m = 0;
  };

  double cell_number(double offset_rad) const;
  const Cell& cell(double sin_bearing, double cos_bearing) const;
  /// Calls visit(bounds) for a cell's buildings between two distances, the nearest first, while it returns
  /// true.
  template <typename Visit>
  static void visit_between(const Cell& cell, double from_m, double to_m, const Visit& visit);

  const Buildings& all_;
  const Sector& sector_;
  double centre_rad_;
  double cells_a_rad_;
  std::vector<Cell> cells_;
};

}  // namespace obliq
