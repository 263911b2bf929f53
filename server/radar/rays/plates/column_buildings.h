#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/frame_plan.h"

namespace obliq {

/// A part of a column's width in which no building has a corner, as the vertical plane at its middle.
struct SubColumn {
  double sin_bearing = 0;
  double cos_bearing = 1;
  double weight = 1;  ///< of the column's width; all weights add up to 1
};

/// The buildings that reach into a column of pixels, by elevation. A building is often narrower than the
/// column at its distance, and the plane in the column's middle meets all of it or none; sub-columns, cut at
/// its corners, give it its share of the light.
class ColumnBuildings {
 public:
  ColumnBuildings() = default;
  ColumnBuildings(const FramePlan& plan, int azimuth_bin, double sin_bearing, double cos_bearing,
                  double width_rad);

  /// The sub-columns for elevations between two slopes; none where no building is. Kept until the next call.
  void sub_columns_between(double low_slope, double high_slope, double range_spacing_m,
                           std::vector<SubColumn>& sub_columns) const;
  /// The buildings of the last call, rising, and how near the nearest of them is.
  const std::vector<std::uint32_t>& between() const { return between_; }
  double nearest_between_m() const { return nearest_between_m_; }

 private:
  struct Standing {
    std::uint32_t building = 0;
    double low_slope = 0;   // of its base
    double high_slope = 0;  // of its roof
    double near_m = 0;
    double far_m = 0;
    std::vector<double> cuts;  // corners inside the column, as fractions of its width
  };

  std::vector<Standing> standing_;
  double sin_bearing_ = 0;
  double cos_bearing_ = 1;
  double width_rad_ = 0;
  mutable std::vector<std::uint32_t> between_;
  mutable std::vector<double> cuts_;
  mutable double nearest_between_m_ = 0;
};

}  // namespace obliq
