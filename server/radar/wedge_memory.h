#pragma once
#include <cstdint>

#include "server/radar/settings.h"

namespace obliq {

/// An upper estimate of the memory that a thread needs for its wedge: bins, profiles, scatterers, samples
/// that wait, and hits. It leaves out the scene, the frame's plan and planes that wait to be sent.
std::int64_t wedge_bytes(const RadarSettings& settings);

/// What a rendering by so many threads holds at once: their wedges, and the sharp ones that a beam adds up.
std::int64_t rendering_bytes(const RadarSettings& settings, std::int64_t threads);

}  // namespace obliq
