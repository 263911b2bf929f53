#pragma once
#include <vector>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq {

/// How the beam and the pulse fit each other, the sector and the bins.
void check_beam(const RadarSettings& settings, std::vector<FieldError>& errors);

}  // namespace obliq
