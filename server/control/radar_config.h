#pragma once
#include <string>

#include "server/radar/settings.h"

namespace obliq {

/// One named radar as it is configured: how it looks and where it stands.
struct RadarConfig {
  std::string name = "main";
  RadarSettings settings;
  PoseSettings pose;
  bool finds_pixels = false;  ///< pixel_columns and pixel_rows are to be found (server/loading/find_pixels.h)
};

}  // namespace obliq
