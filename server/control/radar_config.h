#pragma once
#include <string>

#include "server/radar/settings.h"

namespace obliq {

/// One named radar as it is configured: how it looks and where it stands.
struct RadarConfig {
  std::string name = "main";
  RadarSettings settings;
  PoseSettings pose;
};

}  // namespace obliq
