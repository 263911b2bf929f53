#pragma once
#include "server/radar/frame_plan.h"

namespace obliq {

/// Asks for the heights under a wedge row by row, so that they are in the second-level cache when planes
/// march through it: a march waits for each line of the cache, and rows can be waited for all at once. Does
/// nothing for a wedge that such a cache would not hold.
void prefetch_ground(const FramePlan& plan, AzimuthRange range);

}  // namespace obliq
