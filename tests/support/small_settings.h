#pragma once
#include "tests/support/scenes.h"

namespace obliq::test {

/// A frame of few pixels and bins, 2 to 8 km away.
inline SettingsPtr small_settings(FrustumKind kind) {
  RadarSettings settings;
  settings.frustum = kind;
  settings.r_min_m = 2000;
  settings.r_max_m = 8000;
  settings.pixel_columns = settings.pixel_rows = 64;
  settings.azimuth_bins = settings.range_bins = 32;
  return snapshot(settings);
}

}  // namespace obliq::test
