#pragma once
#include <vector>

#include "server/radar/profile/roofs.h"

namespace obliq {

/// A stretch of a vertical plane under one roof: the highest where footprints overlap.
struct RoofStep {
  double near_m;
  double far_m;
  double roof_y_m;
  double base_y_m;
  std::uint32_t building;
  std::uint32_t
      wall;  ///< face through which the plane enters at near_m; kNoFace when a higher roof ends there
};

/// Footprint stretches as disjoint steps, sorted by distance. `spans` is sorted on the way.
std::vector<RoofStep> disjoint_roofs(const Buildings& buildings, std::vector<FootprintSpan>& spans);

}  // namespace obliq
