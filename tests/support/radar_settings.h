#pragma once
// Settings of radars, in a line.
#include "server/radar/settings.h"

namespace obliq::test {

struct Swath {
  double r_min_m = 3700, r_max_m = 37000, sector_deg = 120;
};
struct BinCounts {
  int azimuth = 1024, range = 1024;
};
struct Pixels {
  int columns = 2048, rows = 2048;
};

inline RadarSettings radar_settings(FrustumKind kind, const Swath& swath, BinCounts bins,
                                    Pixels pixels = {}) {
  RadarSettings settings;
  settings.frustum = kind;
  settings.r_min_m = swath.r_min_m;
  settings.r_max_m = swath.r_max_m;
  settings.sector_deg = swath.sector_deg;
  settings.azimuth_bins = bins.azimuth;
  settings.range_bins = bins.range;
  settings.pixel_columns = pixels.columns;
  settings.pixel_rows = pixels.rows;
  return settings;
}

/// Of a frame that takes milliseconds, over the hills of synthetic_spec.
inline RadarSettings small_frame(FrustumKind kind) {
  return radar_settings(kind, {1500, 6000, 90}, {40, 64}, {200, 150});
}

}  // namespace obliq::test
