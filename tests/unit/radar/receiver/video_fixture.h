#pragma once
// A radar whose video is tested, bins of one power, and the coding by the library's arithmetic.
#include <algorithm>
#include <cmath>

#include "server/radar/bins.h"
#include "server/radar/receiver/receiver.h"
#include "tests/support/scenes.h"

namespace obliq::test {

inline RadarSettings radar() {
  RadarSettings settings = radar_settings(FrustumKind::oblique, {1000, 1000 + 30.0 * 512}, {64, 512});
  settings.video.floor_auto = false;
  settings.video.floor_db = -150;
  settings.video.span_db = 100;
  return settings;
}

inline BinBlock video_of(const RadarSettings& settings, BinBlock bins,
                         ReceivedPlanes wanted = {true, true, true}) {
  Receiver(settings, "main", 3).receive(bins, wanted);
  return bins;
}

/// One azimuth bin, all of it of one power.
inline BinBlock even(const RadarSettings& settings, double power_w) {
  BinBlock bins(0, settings.azimuth_bins, settings.range_bins);
  for (auto& v : bins.iq) v = static_cast<float>(std::sqrt(power_w));
  for (double& p : bins.power_w) p = power_w;
  return bins;
}

/// The coding of the issue, in the library's arithmetic.
inline int level_of(double power_w, double floor_db, double span_db, int n) {
  if (power_w == 0) return 0;
  const double x = 10 * std::log10(power_w);
  return static_cast<int>(
      std::clamp(1 + std::round((n - 2) * (x - floor_db) / span_db), 1.0, static_cast<double>(n - 1)));
}

}  // namespace obliq::test
