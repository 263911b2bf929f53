#pragma once
// What holds for every frame, whatever the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "server/radar/render.h"
#include "server/scene/materials.h"

namespace obliq::test {

constexpr double kPi = std::numbers::pi;
constexpr double kSpeedOfLight_m_s = 299792458.0;

/// K of the radar equation, P = K sigma / r^4, written out again from PAPER.md, eq. 13.
inline double radar_constant(const RadarSettings& s) {
  const double lambda = kSpeedOfLight_m_s / (s.frequency_ghz * 1e9);
  const double gain = std::pow(10.0, s.gain_db / 10);
  return s.power_w * gain * gain * lambda * lambda / std::pow(4 * kPi, 3);
}

/// Most that sigma / (solid angle x r^2) can be for diffuse and specular materials. The lobe
/// (1 + t^2)^(5/2) exp(-t^2 / 2 s^2) is greatest at 1 + t^2 = 5 s^2, or head on when that is below 1.
inline double greatest_gamma(const std::vector<Material>& materials) {
  double greatest = 0;
  for (const Material& m : materials) {
    double gamma = m.gamma;
    if (m.model == ScatteringModel::geometric_optics) {
      const double s2 = m.rms_slope * m.rms_slope;
      const double sec2 = std::max(1.0, 5 * s2);
      gamma += m.reflectivity / (2 * s2) * std::pow(sec2, 2.5) * std::exp(-(sec2 - 1) / (2 * s2));
    }
    greatest = std::max(greatest, gamma);
  }
  return greatest;
}

struct Totals {
  double power_w = 0;
  std::size_t of_state[5] = {0, 0, 0, 0, 0};
  double nearest_m = 0;   ///< near edge of the nearest bin with samples
  double farthest_m = 0;  ///< far edge of the farthest
};

/// No NaN, no infinity, no negative power; a bin has samples exactly when it says so; the five states
/// partition the bins; and energy is bounded: power times r^2 over all bins is at most K gamma times the
/// solid angle of the sector, 2 x S for the whole sphere's height. Half a percent for pixels that reach over
/// the sector's edges. A version that writes sigma as sigma0 A with A = dOmega r^2 / cos(theta) breaks the
/// bound at grazing, one that forgets the clamp of the specular lobe breaks finiteness.
inline Totals expect_sane(const Frame& frame, const RadarSettings& s,
                          const std::vector<Material>& materials) {
  Totals totals;
  const BinBlock& b = frame.bins;
  const std::size_t n = static_cast<std::size_t>(b.n_azimuth) * static_cast<std::size_t>(b.n_range);
  EXPECT_EQ(b.power_w.size(), n);
  const double spacing = (s.r_max_m - s.r_min_m) / s.range_bins;
  double weighted = 0;
  std::uint64_t samples = 0;
  std::size_t broken = 0;
  totals.nearest_m = HUGE_VAL;
  for (std::size_t k = 0; k < n; ++k) {
    const std::complex<double> iq(b.iq[k]);
    const double power = b.power_w[k];
    const bool good = std::isfinite(iq.real()) && std::isfinite(iq.imag()) && std::isfinite(power) &&
                      power >= 0 && b.state[k] <= 4 && (b.count[k] > 0) == (b.state[k] == 1) &&
                      (b.count[k] > 0 || (power == 0 && b.iq[k] == std::complex<float>{}));
    if (!good && ++broken <= 3) {
      ADD_FAILURE() << "bin " << k / static_cast<std::size_t>(b.n_range) << ", "
                    << k % static_cast<std::size_t>(b.n_range) << ": iq " << iq.real() << " " << iq.imag()
                    << ", power " << power << ", count " << b.count[k] << ", state " << int{b.state[k]};
    }
    totals.power_w += power;
    ++totals.of_state[std::min<std::size_t>(b.state[k], 4)];
    samples += b.count[k];
    const double r1 = s.r_min_m + static_cast<double>(k % static_cast<std::size_t>(b.n_range)) * spacing;
    weighted += power * (s.range_normalisation ? 1 / ((r1 + spacing) * (r1 + spacing)) : r1 * r1);
    if (b.count[k] > 0) {
      totals.nearest_m = std::min(totals.nearest_m, r1);
      totals.farthest_m = std::max(totals.farthest_m, r1 + spacing);
    }
  }
  EXPECT_EQ(broken, 0u);
  EXPECT_EQ(samples, frame.stats.samples);
  const double sector_rad = s.sector_deg * kPi / 180;
  EXPECT_LE(weighted, 1.005 * radar_constant(s) * greatest_gamma(materials) * 2 * sector_rad);
  return totals;
}

/// Power of the whole sector over flat ground of constant gamma `below_m` under the antenna, from the closed
/// form of PAPER.md, definitions.
inline double flat_ground_power_w(const RadarSettings& s, double gamma, double below_m) {
  const double r1 = std::max(s.r_min_m, below_m);
  return radar_constant(s) * gamma * (s.sector_deg * kPi / 180) * below_m *
         (1 / (r1 * r1 * r1) - 1 / (s.r_max_m * s.r_max_m * s.r_max_m)) / 3;
}

}  // namespace obliq::test
