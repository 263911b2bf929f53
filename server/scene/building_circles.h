#pragma once
#include <cstddef>
#include <vector>

#include "terrain/buildings/buildings.h"

namespace obliq {

/// A circle around each building's outline, and the roof's height over it: enough to pass most buildings over
/// without a look at their corners. World frame. Arrays, for loops that take several buildings at a time.
struct BuildingCircles {
  std::vector<float> x_m;       ///< [n]
  std::vector<float> z_m;       ///< [n]
  std::vector<float> radius_m;  ///< [n], rounded up: no corner is farther from the centre
  std::vector<float> roof_y_m;  ///< [n]
  double reach_m = 0;           ///< no coordinate of a centre is larger, whatever its sign

  explicit BuildingCircles(const Buildings& buildings);

  std::size_t size() const { return x_m.size(); }
  std::size_t bytes() const { return 4 * x_m.capacity() * sizeof x_m[0]; }
};

}  // namespace obliq
