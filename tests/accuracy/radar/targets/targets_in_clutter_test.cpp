// A target beside the clutter of level ground, against closed forms written out here: gamma h theta_eq ct/2
// over the beam's and the pulse's own shape, and k T B.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "tests/support/target_scenes.h"

namespace obliq::test::targets_in_clutter_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLightSpeed_m_s = 299792458.0;

/// X band, 3 degrees, 0.25 us, without a pattern in elevation; bins far finer than the pulse.
RadarSettings radar_around(double range_m) {
  RadarSettings s =
      radar_settings(FrustumKind::sweep, {range_m - 250, range_m + 250, 30}, {120, 250}, {120, 1});
  s.frequency_ghz = 9.4;
  s.power_w = 50e3;
  s.gain_db = 33;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 3;
  s.beam.extent_deg = 12;
  s.pulse.kind = PulseKind::rectangular;
  s.pulse.length_us = 0.25;
  s.receiver.noise = true;
  s.receiver.noise_figure_db = 4;
  return s;
}

double constant_of(const RadarSettings& s) {
  const double lambda = kLightSpeed_m_s / (s.frequency_ghz * 1e9);
  return s.power_w * std::pow(10, s.gain_db / 5) * lambda * lambda / std::pow(4 * kPi, 3);
}

/// Of k T B, 290 K at the antenna.
double noise_of(const RadarSettings& s) {
  return 1.380649e-23 * 290 * std::pow(10, s.receiver.noise_figure_db / 10) / (s.pulse.length_us * 1e-6);
}

// The mean cross section of the ground in a bin: gamma = -15 dB, 1 km up, theta_eq of a Gaussian beam two
// ways, two thirds of the pulse's length for a matched filter's triangle, and 1 / cos(e) of a wider beam on
// the ground.
TEST(TargetsInClutter, OfLevelGroundHaveTheRatiosOfClosedForms) {
  const struct {
    double range_m, clutter_dbsm, clutter_to_noise_db;
  } kWanted[] = {{2000, 15.56, 0},      {3000, 15.19, 0},      {5000, 15.02, 51.10},
                 {10000, 14.95, 39.00}, {20000, 14.94, 26.94}, {37000, 14.93, 16.25}};
  std::vector<Material> materials = two_materials();
  materials[0].gamma = std::pow(10, -1.5);
  const TargetScene scene(made_world(40000, 200, [](double, double) { return 0.0; }), kAntenna_m, materials);
  for (const auto& wanted : kWanted) {
    const RadarSettings s = radar_around(wanted.range_m);
    const Bin at = bin_near(s, 0, wanted.range_m);
    Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
    target.size.swerling = 0;
    target.size.rcs_dbsm = 10;
    const Difference frames = scene.difference(s, {target});
    const double noise_w = noise_of(s);
    const double clutter_w = frames.without.bins.power_w[frames.index(at)];  // the plane of mean echoes
    const double clutter_dbsm = db(clutter_w * std::pow(at.range_m, 4) / constant_of(s));
    const double theta_eq = 3 * kPi / 180 * std::sqrt(kPi / (8 * std::numbers::ln2));
    const double cosine = std::sqrt(1 - std::pow(kAntenna_m / at.range_m, 2));
    const double cell_m = kLightSpeed_m_s * s.pulse.length_us * 1e-6 / 2;
    const double closed = std::pow(10, -1.5) * kAntenna_m * theta_eq * cell_m * 2 / 3 / cosine;
    EXPECT_NEAR(clutter_dbsm, db(closed), 0.03) << wanted.range_m;
    EXPECT_NEAR(clutter_dbsm, wanted.clutter_dbsm, 0.03) << wanted.range_m;
    EXPECT_NEAR(db(frames.power_w(at) / clutter_w), 10 - db(closed), 0.03) << wanted.range_m;
    if (wanted.clutter_to_noise_db > 0) {
      EXPECT_NEAR(db(clutter_w / noise_w), wanted.clutter_to_noise_db, 0.04) << wanted.range_m;
    }
    std::printf(
        "    %5.0f km: clutter %.3f dBsm (%.2f), target to clutter %.3f dB, clutter to noise %.3f dB\n",
        wanted.range_m / 1000, clutter_dbsm, wanted.clutter_dbsm, db(frames.power_w(at) / clutter_w),
        db(clutter_w / noise_w));
  }
}

}  // namespace
}  // namespace obliq::test::targets_in_clutter_test
