#pragma once
#include <vector>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq {

/// Why a mode that looks at Doppler does not go with the radar's other settings, wherever it is and however
/// it flies.
void check_doppler(const RadarSettings& settings, std::vector<FieldError>& errors);

}  // namespace obliq
