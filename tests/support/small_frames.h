#pragma once
// Frames that take milliseconds, over the hills of synthetic_spec, and whether two have the same bits.
#include <cstring>
#include <vector>

#include "server/radar/settings.h"

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

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace obliq::test
