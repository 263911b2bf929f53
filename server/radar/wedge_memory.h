#pragma once
#include <cstdint>

#include "server/radar/settings.h"

namespace obliq {

/// What a thread needs for the wedge in its hands, about, from above: bins, profiles, scatterers, samples
/// that wait, and what a wedge's pixels meet. The scene, the frame's plan and planes that wait to be sent are
/// not in it.
std::int64_t wedge_bytes(const RadarSettings& settings);

}  // namespace obliq
