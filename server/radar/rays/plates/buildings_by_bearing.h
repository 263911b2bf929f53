#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/profile/local_sight.h"

namespace obliq {

/// The buildings of one azimuth bin by bearing and distance: which of them a vertical plane through the
/// antenna can meet. A bin may be the whole sector, with thousands of buildings. Immutable.
class BuildingFan {
 public:
  BuildingFan(const FramePlan& plan, int azimuth_bin);

  /// Appends the roof stretches of the plane along a world direction, those of all buildings that it can meet
  /// between two distances, the nearest building first.
  void add_stretches(double from_m, double to_m, double sin_bearing, double cos_bearing,
                     std::vector<RoofSpan>& stretches) const;

  /// How many buildings are looked at for a direction, whatever their distance.
  std::size_t candidates(double sin_bearing, double cos_bearing) const {
    return cell(sin_bearing, cos_bearing).buildings.size();
  }

 private:
  /// A building as the distances between which a plane can meet it.
  struct Standing {
    double near_m = 0;
    double far_m = 0;
    std::uint32_t building = 0;
  };
  /// A stretch of bearings.
  struct Cell {
    std::vector<Standing> buildings;  // by near_m
    double longest_m = 0;
  };

  Standing standing(std::uint32_t building) const;
  double cell_number(double offset_rad) const;
  const Cell& cell(double sin_bearing, double cos_bearing) const;

  const Buildings& all_;
  const Sector& sector_;
  double centre_rad_;
  double cells_a_rad_;
  std::vector<Cell> cells_;
};

}  // namespace obliq
