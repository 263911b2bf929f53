#pragma once
#include <string>
#include <vector>

#include "server/radar/doppler/ground_doppler.h"
#include "server/radar/settings.h"

namespace obliq {

/// What a frame in a mode that looks at Doppler cannot show as it should, and what would mend it.
std::vector<std::string> doppler_warnings(const RadarSettings& settings, const SectorVelocity& velocity);

}  // namespace obliq
