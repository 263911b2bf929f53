#pragma once
#include <vector>

#include "server/explain/measurement.h"

namespace obliq {

/// How far a change of the model moves the ground, as the antenna sees it. Metres.
struct GroundShift {
  double slant_m = 0;     ///< greatest change of a ground point's slant range
  double vertical_m = 0;  ///< greatest change of its height below the antenna
};

/// Points of the ground in sector and swath that are looked up again in a changed world. Positions (x, z) are
/// the same in every earth of one origin.
class GroundProbes {
 public:
  GroundProbes(const FramePlan& plan, const std::vector<AzimuthRange>& wedges);

  /// Where both worlds know the ground.
  GroundShift shift_in(const World& world, const Pose& pose) const;

  std::size_t size() const { return points_.size(); }

 private:
  struct Point {
    double x_m, z_m, below_antenna_m, slant_m;
  };
  std::vector<Point> points_;
};

}  // namespace obliq
