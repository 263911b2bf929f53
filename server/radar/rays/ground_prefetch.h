#pragma once
#include <glm/vec3.hpp>

#include "server/radar/simd/exact_math.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Asks for the heights between two bearings (sin and cos of world angles, less than half a turn apart) and
/// up to a ground distance, row by row, so that they are in the second-level cache when rays walk through
/// them: a walk waits for each line of the cache, and rows can be waited for all at once. Does nothing for a
/// wedge that such a cache would not hold. Planes that march side by side ask on their way (cell_lanes.h).
void prefetch_ground(const HeightGrid& grid, const glm::dvec3& antenna_m, SinCos left, SinCos right,
                     double reach_m);

}  // namespace obliq
