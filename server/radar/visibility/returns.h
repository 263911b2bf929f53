#pragma once
#include <cstdint>

#include "server/radar/scene_plan.h"

namespace obliq {

/// Raises Labels::returns of an azimuth bin, most[n_range]: vertical planes, of cameras one, are marched over
/// ground, walls and roofs, and of each range bin the plane with most stretches counts. What is seen before
/// and behind a shadow is two stretches; a wall is one with the ground at its foot and with its roof.
void count_returns(const ScenePlan& plan, int azimuth_bin, std::uint8_t* most);

}  // namespace obliq
