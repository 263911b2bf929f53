#pragma once
// Frames that take milliseconds, over the hills of synthetic_spec, and whether two have the same bits.
#include "server/radar/settings.h"
#include "tests/support/same_bits.h"

namespace obliq::test {

inline RadarSettings small_frame(FrustumKind kind) {
  RadarSettings settings;
  settings.frustum = kind;
  settings.sector_deg = 90;
  settings.azimuth_bins = 40;
  settings.range_bins = 64;
  settings.pixel_columns = 200;
  settings.pixel_rows = 150;
  settings.r_min_m = 1500;
  settings.r_max_m = 6000;
  return settings;
}

}  // namespace obliq::test
