// Targets in trains of pulses, against geometry and against vectors that others have published.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <vector>

#include "tests/support/train_scenes.h"

namespace obliq::test::pulses_targets_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLightSpeed_m_s = 299792458.0;

World no_ground() {
  return made_world(13000, 100, [](double, double) { return 0.0; });
}
std::vector<Material> black() {
  std::vector<Material> materials = two_materials();
  for (Material& material : materials) material.gamma = 1e-30;
  return materials;
}

/// In the air, at an azimuth, a slant range and the antenna's height.
Target in_the_air(const TargetScene& scene, double range_m) {
  Target target = scene.at(0, range_m, 0);
  target.height_reference = HeightReference::datum;
  target.size.swerling = 0;
  target.size.rcs_dbsm = 10;
  const glm::dvec3 at(0, scene.pose().antenna.m.y, range_m);
  const Geodetic place = scene.world().frame.geodetic_from_world({at});
  target.latitude_deg = place.latitude_rad / kDegree_rad;
  target.longitude_deg = place.longitude_rad / kDegree_rad;
  target.height_m = place.height_m;
  return target;
}

/// Turns from pulse to pulse, unwrapped from the first.
std::vector<double> turns_of(const PulseTrain& train, int gate) {
  std::vector<double> turns{0};
  for (int n = 1; n < train.n_pulses; ++n)
    turns.push_back(turns.back() +
                    std::arg(sample(train, n, gate) * std::conj(sample(train, n - 1, gate))) / (2 * kPi));
  return turns;
}

int strongest_gate(const PulseTrain& train, int pulse) {
  int best = 0;
  for (int m = 0; m < train.n_range; ++m)
    if (std::norm(sample(train, pulse, m)) > std::norm(sample(train, pulse, best))) best = m;
  return best;
}

TEST(PulsesOfTargets, ATowerTurnsAsTheAntennaFliesPastIt) {
  TargetScene scene(no_ground(), kAntenna_m, black());
  fly(scene, 150, 40, 3);
  RadarSettings s = train_settings();
  s.pulse.prf_hz = 20000;
  s.doppler.pulses = 65;
  const Target tower = in_the_air(scene, 6010);
  const PulseTrain train = train_of(scene, s, {.targets = {tower}});
  const int gate = strongest_gate(train, 32);
  const std::vector<double> turns = turns_of(train, gate);
  // An odd train's middle pulse is at time 0: its slope is the central difference, less the third order.
  const double dt = 32 / s.pulse.prf_hz;
  const double slope_hz = (turns[64] - turns[0]) / (2 * dt);
  const double lambda = kLightSpeed_m_s / 9.4e9;
  const double wanted_hz = 2 * 150 * std::cos(40 * kDegree_rad) / lambda;
  EXPECT_NEAR(slope_hz / wanted_hz, 1, 1e-6);
  std::printf("    %.6f Hz of %.6f\n", slope_hz, wanted_hz);
}

TEST(PulsesOfTargets, HaveThePhasesThatRadarSimPyHas) {
  // 35 GHz, going away at 150 m/s from 1000 m; samples 39 and 40 at 6 MHz
  // (tests/test_system_pulsed_radar.py). Theirs is atan2(re, im) of the conjugate: ours is theirs less a
  // quarter of a turn.
  TargetScene scene(no_ground(), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.frequency_ghz = 35;
  s.r_min_m = 600;
  s.r_max_m = 1400;
  s.pulse.prf_hz = 20000;
  s.doppler.pulses = 3;
  const struct {
    double range_m;
    int sample_number;
    double published_rad;
  } kPublished[] = {{1000, 39, 0.97831584}, {1000, 40, 0.94163854}, {2000, 79, 0.34915804}};
  for (const auto& vector : kPublished) {
    s.r_min_m = vector.range_m - 400;
    s.r_max_m = vector.range_m + 400;
    // Of the middle pulse, where it is by then.
    const double range_m = vector.range_m + 150 * vector.sample_number / 6e6;
    Target target = in_the_air(scene, range_m);
    const PulseTrain train = train_of(scene, s, {.targets = {target}});
    const int gate = strongest_gate(train, 1);
    // The target's own phase is a draw: that of one at a whole number of half waves.
    const double lambda = kLightSpeed_m_s / 35e9;
    Target reference = in_the_air(scene, std::round(range_m / lambda * 2) * lambda / 2);
    const PulseTrain zero = train_of(scene, s, {.targets = {reference}});
    const double found_rad =
        std::arg(sample(train, 1, gate) * std::conj(sample(zero, 1, strongest_gate(zero, 1))));
    EXPECT_NEAR(std::remainder(found_rad - (vector.published_rad - kPi / 2), 2 * kPi), 0, 2e-6);
    std::printf("    %.8f rad (%.8f)\n", found_rad, std::remainder(vector.published_rad - kPi / 2, 2 * kPi));
  }
}

TEST(PulsesOfTargets, FoldAtTheirInterval) {
  // 14 km at an interval of 80 us is at 2,008.302 m (RadarSimPy, the same file: 2 km within three samples).
  TargetScene scene(made_world(20000, 100, [](double, double) { return 0.0; }), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.r_min_m = 1500;
  s.r_max_m = 2500;
  s.range_bins = 500;
  s.pulse.prf_hz = 12500;
  const PulseTrain train = train_of(scene, s, {.targets = {in_the_air(scene, 14000)}});
  const double found_m = s.r_min_m + (strongest_gate(train, 3) + 0.5) * s.range_bin_m();
  EXPECT_NEAR(found_m, 2008.302, s.range_bin_m() / 2 + 1e-6);
  s.pulse.prf_hz = 5000;  // 30 km
  const PulseTrain far = train_of(scene, s, {.targets = {in_the_air(scene, 14000)}});
  const auto seen = static_cast<float>(std::norm(sample(train, 3, strongest_gate(train, 3))));
  for (const auto& iq : far.iq) ASSERT_LT(std::norm(iq), 1e-12F * seen);
}

TEST(PulsesOfTargets, WalkThroughRangeAndShowNearerByTheirChirp) {
  TargetScene scene(no_ground(), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.range_bins = 1000;
  s.pulse.kind = PulseKind::compressed;
  s.pulse.length_us = 10;
  s.pulse.bandwidth_mhz = 10;
  s.doppler.pulses = 64;
  Target target = in_the_air(scene, 6000);
  target.velocity_m_s = {0, 0, -300};
  const PulseTrain train = train_of(scene, s, {.targets = {target}});
  const auto centre_m = [&](int pulse) {
    double power = 0, sum = 0;
    for (int m = 0; m < train.n_range; ++m) {
      const double p = std::norm(sample(train, pulse, m));
      power += p;
      sum += p * (s.r_min_m + (m + 0.5) * s.range_bin_m());
    }
    return sum / power;
  };
  EXPECT_NEAR(centre_m(0) - centre_m(63), 300 * 63e-3, 0.02);
  const double coupling_m = -2 * 300 / (kLightSpeed_m_s / 9.4e9) * 10e-6 * kLightSpeed_m_s / 2e7;
  EXPECT_NEAR(coupling_m, -2.82, 0.005);
  EXPECT_NEAR((centre_m(31) + centre_m(32)) / 2, 6000 + coupling_m, 0.05);
}

TEST(PulsesOfTargets, FlyIntoTheGates) {
  TargetScene scene(no_ground(), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.doppler.pulses = 1000;
  Target target = in_the_air(scene, 7050);  // the gates end at 7000
  target.velocity_m_s = {0, 0, -500};
  const PulseTrain train = train_of(scene, s, {.targets = {target}});
  const auto last = static_cast<std::size_t>(s.range_bins - 1);
  const auto seen = [&](int pulse) { return std::abs(sample(train, pulse, static_cast<int>(last))); };
  const double full = seen(640);
  EXPECT_GT(full, 0);
  for (int pulse = 0; pulse < 1000; pulse += 7) {
    const double range_m = 7050 - 500 * (pulse - 499.5) * 1e-3;
    if (std::abs(range_m - 7000) < 1) continue;
    EXPECT_EQ(seen(pulse) > 0.5 * full, range_m < 7000 && range_m > 7000 - s.range_bin_m()) << pulse;
  }
}

TEST(PulsesOfTargets, AreEclipsedWhereTheyShow) {
  TargetScene scene(made_world(20000, 100, [](double, double) { return 0.0; }), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.r_min_m = 100;
  s.r_max_m = 2100;
  s.range_bins = 1000;
  s.pulse.prf_hz = 12500;
  s.pulse.kind = PulseKind::rectangular;
  s.pulse.length_us = 10;  // c tau / 2 = 1499 m
  const auto peak = [&](double range_m, bool eclipse) {
    s.pulse.eclipse = eclipse;
    const PulseTrain train = train_of(scene, s, {.targets = {in_the_air(scene, range_m)}});
    return std::abs(sample(train, 3, static_cast<int>((750 - s.r_min_m) / s.range_bin_m())));
  };
  for (const double trip : {0.0, 1.0})
    EXPECT_NEAR(peak(750 + trip * 11991.69832, true) / peak(750 + trip * 11991.69832, false), 750 / 1498.96,
                1e-3)
        << trip;
}

TEST(PulsesOfTargets, OfSwerlingTwoAreDrawnInEachPulse) {
  TargetScene scene(no_ground(), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.doppler.pulses = 512;
  for (const int swerling : {0, 1, 2, 3, 4}) {
    Target target = in_the_air(scene, 6010);
    target.size.swerling = swerling;
    const PulseTrain train = train_of(scene, s, {.targets = {target}, .draw = 7});
    const int gate = strongest_gate(train, 0);
    double mean = 0, square = 0;
    for (int n = 0; n < 512; ++n) {
      const double p = std::norm(sample(train, n, gate));
      mean += p / 512;
      square += p * p / 512;
    }
    const double contrast = square / (mean * mean) - 1;
    const double wanted[] = {0, 0, 1, 0, 0.5};
    EXPECT_NEAR(contrast, wanted[swerling], wanted[swerling] > 0 ? 0.3 : 1e-9) << swerling;
  }
}

TEST(PulsesOfTargets, HaveTheBeamsArcOfAnAntennaThatTurns) {
  TargetScene scene(no_ground(), kAntenna_m, black());
  RadarSettings s = train_settings();
  s.doppler.pulses = 61;
  s.pulse.prf_hz = 600;
  const PulseTrain train = train_of(scene, s, {.targets = {in_the_air(scene, 6010)}, .rate_deg_s = 60});
  const int gate = strongest_gate(train, 30);
  for (int n = 0; n < 61; n += 5) {
    const double away_deg = (n - 30) * 0.1;
    const double wanted = std::exp(-4 * std::log(2.0) * away_deg * away_deg / 9);
    EXPECT_NEAR(std::abs(sample(train, n, gate)) / std::abs(sample(train, 30, gate)), wanted, 2e-4) << n;
  }
}

}  // namespace
}  // namespace obliq::test::pulses_targets_test
