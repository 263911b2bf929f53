#pragma once
#include <cstdint>

#include "server/radar/settings.h"

namespace obliq {

/// An upper estimate of the memory that a thread needs for its wedge: bins, profiles, scatterers, samples
/// that wait, and hits. It leaves out the scene, the frame's plan and planes that wait to be sent.
std::int64_t wedge_bytes(const RadarSettings& settings);

}  // namespace obliq
