#pragma once
#include "server/radar/receiver/weather.h"

namespace obliq {

class ScenePlan;

/// Where the antenna is in the air.
AirView air_view(const ScenePlan& plan);

}  // namespace obliq
