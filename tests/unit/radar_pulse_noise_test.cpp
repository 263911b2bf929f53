// Noise behind a pulse: its power, and its correlation in range.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/radar/beam/point_response.h"
#include "server/radar/receiver/noise.h"
#include "tests/support/silent_radar.h"

namespace obliq::test {
namespace {

/// |sum a[k] conj(a[k + lag])| over the power, along rows.
double autocorrelation(const BinBlock& bins, int lag) {
  std::complex<double> sum = 0;
  double power = 0;
  for (int a = 0; a < bins.n_azimuth; ++a)
    for (int r = 0; r + lag < bins.n_range; ++r) {
      const auto k = static_cast<std::size_t>(a * bins.n_range + r);
      const std::complex<double> v(bins.iq[k]);
      sum += v * std::conj(std::complex<double>(bins.iq[k + static_cast<std::size_t>(lag)]));
      power += std::norm(v);
    }
  return sum.real() / power * bins.n_range / (bins.n_range - lag);
}

TEST(Noise, OfARectangularPulseHasItsTriangleInRange) {
  RadarSettings settings = noisy();
  settings.pulse.kind = PulseKind::rectangular;
  for (const double bins_a_pulse : {0.4, 1.0, 3.0, 4.6}) {
    settings.pulse.length_us = bins_a_pulse * 30 * 2 / kSpeedOfLight_m_s * 1e6;
    EXPECT_NEAR(noise_power_w(settings) /
                    (1.380649e-23 * 290 * std::pow(10, 0.4) / (settings.pulse.length_us * 1e-6)),
                1, 1e-9);
    const BinBlock bins = received(settings, silence(settings));
    const double error = 5 * std::sqrt(std::max(1.0, bins_a_pulse) / static_cast<double>(bins.iq.size()));
    EXPECT_NEAR(mean_power(bins) / noise_power_w(settings), 1, error) << bins_a_pulse;
    for (const int lag : {1, 2, 3, 4, 5, 8}) {
      const double triangle = std::max(0.0, 1 - lag / std::max(1.0, bins_a_pulse));
      EXPECT_NEAR(autocorrelation(bins, lag), triangle, error) << bins_a_pulse << " bins, lag " << lag;
    }
  }
}

TEST(Noise, OfACompressedPulseHasThatOfItsPointResponse) {
  RadarSettings settings = noisy();
  settings.pulse.kind = PulseKind::compressed;
  settings.pulse.bandwidth_mhz = kSpeedOfLight_m_s / (2 * 30 * 2.5) / 1e6;  // 2.5 bins
  settings.pulse.length_us = 10;
  // k T_s L_w / tau, the loss of a Hamming window 1.344 dB (Harris 1978).
  EXPECT_NEAR(
      noise_power_w(settings) / (1.380649e-23 * 290 * std::pow(10, 0.4) * std::pow(10, 0.1344) / 10e-6), 1,
      2e-4);
  const BinBlock bins = received(settings, silence(settings));
  const std::vector<double> p = PointResponse(settings).kernel(30, settings.pulse.extent_bins);
  const auto pp = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t j = 0; j + lag < p.size(); ++j) sum += p[j] * p[j + lag];
    return sum;
  };
  const double error = 5 * std::sqrt(4.0 / static_cast<double>(bins.iq.size()));
  EXPECT_NEAR(mean_power(bins) / noise_power_w(settings), 1, error);
  for (const int lag : {1, 2, 3, 5})
    EXPECT_NEAR(autocorrelation(bins, lag), pp(static_cast<std::size_t>(lag)) / pp(0), error) << lag;
}

}  // namespace
}  // namespace obliq::test
