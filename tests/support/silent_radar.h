#pragma once
// A radar that receives nothing but its own noise.
#include <complex>

#include "server/radar/receiver/receiver.h"
#include "tests/support/radar_settings.h"

namespace obliq::test {

inline constexpr double kSpeedOfLight_m_s = 299792458.0;

/// 64 x 1024 bins of 30 m with noise.
inline RadarSettings noisy() {
  RadarSettings settings = radar_settings(FrustumKind::oblique, {1000, 1000 + 30.0 * 1024}, {64, 1024});
  settings.receiver.noise = true;
  return settings;
}

inline BinBlock silence(const RadarSettings& settings) {
  return {0, settings.azimuth_bins, settings.range_bins};
}

inline BinBlock received(const RadarSettings& settings, BinBlock bins, std::uint64_t counter = 1,
                         const char* radar = "main") {
  Receiver(settings, radar, counter).receive(bins, {});
  return bins;
}

inline double mean_power(const BinBlock& bins) {
  double sum = 0;
  for (const std::complex<float> v : bins.iq) sum += std::norm(std::complex<double>(v));
  return sum / static_cast<double>(bins.iq.size());
}

}  // namespace obliq::test
