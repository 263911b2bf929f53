#pragma once
#include "server/radar/receiver/weather.h"

namespace obliq {

class FramePlan;

/// Where a frame's antenna is in the air.
AirView air_view(const FramePlan& plan);

}  // namespace obliq
