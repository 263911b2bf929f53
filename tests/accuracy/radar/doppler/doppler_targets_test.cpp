// Targets behind Doppler filters, against sums over pulses written out here.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include "tests/support/target_scenes.h"

namespace obliq::test::doppler_targets_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLightSpeed_m_s = 299792458.0;

RadarSettings radar(RadarMode mode) {
  RadarSettings s = beam_settings();
  s.mode = mode;
  s.frequency_ghz = 9.4;
  s.pulse.kind = PulseKind::off;
  s.beam.extent_deg = 8;
  return s;
}

double wavelength_m(const RadarSettings& s) { return kLightSpeed_m_s / (s.frequency_ghz * 1e9); }

/// One that closes at this speed, along the line of sight, on the ground.
Target closing(const TargetScene& scene, const Bin& at, double speed_m_s) {
  Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
  target.size.swerling = 0;
  target.size.rcs_dbsm = 50;
  const double level = std::sqrt(1 - std::pow(kAntenna_m / at.range_m, 2));
  target.velocity_m_s = {-speed_m_s / level * std::sin(at.azimuth_rad), 0,
                         -speed_m_s / level * std::cos(at.azimuth_rad)};
  return target;
}

TEST(DopplerOfTargets, BehindACancellerFollowsItsResponse) {
  const TargetScene scene(level_world());
  RadarSettings s = radar(RadarMode::mti);
  RadarSettings map = s;
  map.mode = RadarMode::map;
  const Bin at = bin_near(s, 0, 6000);
  const double blind_m_s = wavelength_m(s) * s.pulse.prf_hz / 2;
  EXPECT_NEAR(blind_m_s, 15.9464, 1e-4);
  for (const int delays : {1, 2, 3})
    for (const double of_blind : {0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 2.5}) {
      s.doppler.canceller = delays;
      const Target target = closing(scene, at, of_blind * blind_m_s);
      const Frame filtered = scene.render(s, {target});
      const Difference real = scene.difference(map, {target});
      const double noise_gain[] = {1, 2, 6, 20};
      const double wanted = std::pow(2 * std::sin(kPi * of_blind), 2 * delays) / noise_gain[delays];
      const std::size_t k = real.index(at);
      EXPECT_NEAR(filtered.bins.power_w[k] / real.power_w(at), wanted, 1e-6 + 2e-4 * wanted) << of_blind;
      EXPECT_NEAR(std::norm(std::complex<double>(filtered.bins.iq[k])), filtered.bins.power_w[k],
                  1e-3 * filtered.bins.power_w[k])
          << of_blind;
    }
}

TEST(DopplerOfTargets, InASharpenedMapStandWhereTheirDopplerPutsThem) {
  TargetScene scene(level_world());
  const double v = 150, psi = 60 * kPi / 180, own_m_s = 10;
  scene.pose().settings.velocity_north_m_s = v * std::cos(psi);
  scene.pose().settings.velocity_east_m_s = -v * std::sin(psi);
  RadarSettings s = radar(RadarMode::dbs);
  s.pulse.prf_hz = 1000;
  s.doppler.pulses = 64;
  s.beam.width_deg = 6;  // that it is still in the beam where it stands
  s.beam.extent_deg = 14;
  const Bin at = bin_near(s, 0, 6000);
  const Target target = closing(scene, at, own_m_s);
  const Difference frames = scene.difference(s, {target});
  const double level = std::sqrt(1 - std::pow(kAntenna_m / at.range_m, 2));
  const double lambda = wavelength_m(s);
  const double r4 = std::pow(at.range_m, 4);
  const double constant = s.power_w * std::pow(10, s.gain_db / 5) * lambda * lambda / std::pow(4 * kPi, 3);
  const double velocity_m_s[] = {v * std::cos(psi), -v * std::sin(psi)};
  const auto doppler_hz = [&](double azimuth_rad) {
    return 2 / lambda * level *
           (velocity_m_s[0] * std::cos(azimuth_rad) + velocity_m_s[1] * std::sin(azimuth_rad));
  };
  const double own_hz = doppler_hz(at.azimuth_rad) + 2 * own_m_s / lambda;
  double greatest = 0, found_rad = 0;
  for (int k = at.azimuth - 30; k <= at.azimuth + 30; ++k) {
    const double azimuth_rad = (k + 0.5 - s.azimuth_bins / 2.0) * s.azimuth_bin_rad();
    double sum = 0, weights = 0;
    for (int n = 0; n < 64; ++n) {
      const double w = 0.54 - 0.46 * std::cos(2 * kPi * (n + 0.5) / 64);
      sum += w * std::cos(2 * kPi * (own_hz - doppler_hz(azimuth_rad)) * (n - 31.5) / s.pulse.prf_hz);
      weights += w;
    }
    const double own = std::asin(level * std::sin(azimuth_rad - at.azimuth_rad));
    const double gain = std::exp(-4 * std::log(2.0) * std::pow(own / (6 * kPi / 180), 2));
    const double wanted = constant * 1e5 / r4 * std::pow(gain * sum / weights, 2);
    const Bin bin{k, at.range, azimuth_rad, at.range_m};
    EXPECT_NEAR(frames.power_w(bin), wanted, 2e-3 * wanted + 1e-6 * constant * 1e5 / r4) << k;
    if (std::pow(sum / weights, 2) > greatest) {
      greatest = std::pow(sum / weights, 2);
      found_rad = azimuth_rad;
    }
  }
  // Towards the velocity, by v_r / (v cos e sin psi): 4.411 degrees on the level.
  EXPECT_NEAR((found_rad - at.azimuth_rad) * 180 / kPi, -4.411, 0.5);
  std::printf("    mover at %.2f deg\n", (found_rad - at.azimuth_rad) * 180 / kPi);
}

TEST(DopplerOfTargets, InAnImageOfSyntheticApertureAreAsNarrowAsItsResolution) {
  TargetScene scene(level_world());
  scene.pose().settings.velocity_east_m_s = 150;
  RadarSettings s = radar_settings(FrustumKind::sweep, {5900, 6100, 4}, {400, 64}, {400, 1});
  s.mode = RadarMode::sar;
  s.frequency_ghz = 9.4;
  s.doppler.resolution_m = 5;
  s.doppler.window = DopplerWindow::none;
  const Bin at = bin_near(s, 0, 6000);
  Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
  target.size.swerling = 0;
  target.size.rcs_dbsm = 50;
  const Difference frames = scene.difference(s, {target});
  const double peak_w = frames.power_w(at);
  const double level = std::sqrt(1 - std::pow(kAntenna_m / 6000, 2));
  for (int k = -40; k <= 40; ++k) {
    const double cells = level * at.range_m * k * s.azimuth_bin_rad() / s.doppler.resolution_m;
    const double response = k == 0 ? 1 : std::sin(kPi * cells) / (kPi * cells);
    Bin beside = at;
    beside.azimuth += k;
    EXPECT_NEAR(frames.power_w(beside) / peak_w, response * response, 2e-3) << k;
  }
}

}  // namespace
}  // namespace obliq::test::doppler_targets_test
