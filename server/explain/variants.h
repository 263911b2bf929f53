#pragma once
// Changed copies of what a scene is made of.
#include <cstdint>
#include <vector>

#include "server/explain/measurement.h"
#include "terrain/world.h"

namespace obliq {

/// Material ids that ground or buildings of a world have, 0 (the terrain's) left out, rising.
std::vector<std::uint8_t> materials_used(const World& world);

/// Middle sizes of a world's buildings, metres: roofs above the ground, roots of the outlines' areas. 0
/// without any.
struct BuildingSizes {
  double height_m = 0;
  double side_m = 0;
};
BuildingSizes median_sizes(const Buildings& buildings);

/// How far a change of the model moves the ground, as the antenna sees it. Metres.
struct GroundShift {
  double slant_m = 0;     ///< greatest change of a ground point's slant range
  double vertical_m = 0;  ///< greatest change of its height below the antenna
};

/// Points of the ground in sector and swath that are looked up again in a changed world. Positions (x, z) are
/// the same in every earth of one origin.
class GroundProbes {
 public:
  GroundProbes(const FramePlan& plan, const AzimuthRuns& runs);

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
