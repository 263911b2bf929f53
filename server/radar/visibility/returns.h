#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/scene_plan.h"

namespace obliq {

/// Labels::returns of an azimuth bin, [n_range]: two vertical planes are marched over ground, walls and
/// roofs, and of each range bin the plane with more stretches counts. What is seen before and behind a shadow
/// is two stretches; a wall is one with the ground at its foot and with its roof.
std::vector<std::uint8_t> count_returns(const ScenePlan& plan, int azimuth_bin);

}  // namespace obliq
