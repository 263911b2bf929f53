#pragma once
#include <string>
#include <vector>

#include "server/radar/scene_plan.h"

namespace obliq {

/// Slant range at which level water at the datum is seen at that angle of grazing, from height_m above it.
double range_of_grazing_m(double height_m, double grazing_rad, double radius_m);

/// Where this frame's sea lies beyond what its models know, and what it has there instead.
std::vector<std::string> sea_warnings(const ScenePlan& plan);

}  // namespace obliq
