// The echoes of targets: the radar equation by hand, Swerling's laws, arcs of the beam, the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "server/radar/targets/fluctuation.h"
#include "tests/support/same_bits.h"
#include "tests/support/target_scenes.h"

namespace obliq::test::targets_test {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<double> draws(int swerling, int n) {
  std::vector<double> powers;
  for (int k = 0; k < n; ++k)
    powers.push_back(fluctuation(swerling, 7, {.seed = 1, .frame = static_cast<std::uint64_t>(k)}).power);
  std::ranges::sort(powers);
  return powers;
}

/// Greatest distance between the draws' distribution and a law's.
double kolmogorov_smirnov(const std::vector<double>& sorted, const std::function<double(double)>& law) {
  const auto n = static_cast<double>(sorted.size());
  double greatest = 0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const double p = law(sorted[k]);
    greatest = std::max({greatest, p - static_cast<double>(k) / n, static_cast<double>(k + 1) / n - p});
  }
  return greatest;
}

TEST(Fluctuation, FollowsSwerlingsLaws) {
  constexpr int kDraws = 10000;
  const double most = 1.63 / std::sqrt(kDraws);  // one sequence in a hundred is farther off
  for (const int swerling : {1, 2})
    EXPECT_LT(kolmogorov_smirnov(draws(swerling, kDraws), [](double x) { return 1 - std::exp(-x); }), most);
  for (const int swerling : {3, 4})
    EXPECT_LT(kolmogorov_smirnov(draws(swerling, kDraws),
                                 [](double x) { return 1 - (1 + 2 * x) * std::exp(-2 * x); }),
              most);
  for (const double power : draws(0, 100)) EXPECT_EQ(power, 1);
}

// Percentiles of 1, 10, 50, 90 and 99 %: roots of the two laws, found by scipy.stats.gamma.ppf.
TEST(Fluctuation, HasThePercentilesOfChiSquare) {
  constexpr int kDraws = 200000;
  const std::vector<double> shares{0.01, 0.1, 0.5, 0.9, 0.99};
  const auto near = [&](int swerling, const std::vector<double>& wanted) {
    const std::vector<double> sorted = draws(swerling, kDraws);
    for (std::size_t k = 0; k < shares.size(); ++k)
      EXPECT_NEAR(sorted[static_cast<std::size_t>(shares[k] * kDraws)] / wanted[k], 1, 0.05)
          << swerling << " " << shares[k];
  };
  near(1, {0.01005, 0.10536, 0.69315, 2.30259, 4.60517});
  near(3, {0.07428, 0.26591, 0.83917, 1.94486, 3.31918});
}

TEST(Fluctuation, StaysOverAPassOrADwell) {
  const TargetDraw first{.seed = 1, .frame = 5, .dwell = 1};
  const TargetDraw second{.seed = 1, .frame = 5, .dwell = 2};
  for (const int swerling : {0, 1, 3}) {
    EXPECT_EQ(fluctuation(swerling, 7, first).power, fluctuation(swerling, 7, second).power);
    EXPECT_EQ(fluctuation(swerling, 7, first).phase_turns, fluctuation(swerling, 7, second).phase_turns);
  }
  for (const int swerling : {2, 4}) {
    EXPECT_NE(fluctuation(swerling, 7, first).power, fluctuation(swerling, 7, second).power);
    EXPECT_NE(fluctuation(swerling, 7, first).phase_turns, fluctuation(swerling, 7, second).phase_turns);
  }
  // Seed 1 with id 2 is not seed 2 with id 1.
  EXPECT_NE(fluctuation(1, 2, {.seed = 1}).power, fluctuation(1, 1, {.seed = 2}).power);
}

TEST(TargetEchoes, HaveThePowerOfTheRadarEquation) {
  const TargetScene scene(level_world());
  for (const bool beam : {false, true})
    for (const double wanted_m : {2000.0, 5000.0, 10000.0}) {
      const RadarSettings s = beam ? beam_settings() : sharp_settings_of_test();
      const Bin at = bin_near(s, 0.1, wanted_m);
      Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
      target.size.swerling = 0;
      target.size.rcs_dbsm = 10;
      const Difference with = scene.difference(s, {target});
      const double lambda = 299792458.0 / (s.frequency_ghz * 1e9);
      const double gain = std::pow(10, s.gain_db / 10);
      const double power_w =
          s.power_w * gain * gain * lambda * lambda * 10 / (std::pow(4 * kPi, 3) * std::pow(at.range_m, 4));
      EXPECT_NEAR(with.power_w(at) / power_w, 1, 1e-6) << beam << " " << wanted_m;
      EXPECT_NEAR(std::norm(with.voltage(at)) / power_w, 1, 2e-3) << beam << " " << wanted_m;
    }
}

TEST(TargetEchoes, PaintAnArcOfTheBeamsPattern) {
  const TargetScene scene(level_world());
  RadarSettings s = beam_settings();
  const Bin at = bin_near(s, 0.0, 6000);
  Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
  target.size.swerling = 0;
  const Difference with = scene.difference(s, {target});
  const double cosine = std::sqrt(1 - std::pow(kAntenna_m / at.range_m, 2));
  const double width = s.beam.width_deg * kPi / 180;
  for (int k = -20; k <= 20; ++k) {
    const double own = std::asin(cosine * std::sin(k * s.azimuth_bin_rad()));
    const double gain = std::exp(-4 * std::log(2.0) * std::pow(own / width, 2));
    EXPECT_NEAR(with.power_w({at.azimuth + k, at.range}) / with.power_w(at), gain * gain, 1e-4) << k;
  }
}

TEST(TargetEchoes, AreTheSameInEachSpeckle) {
  const TargetScene scene(level_world());
  for (const bool beam : {false, true}) {
    std::vector<std::complex<double>> voltages;
    for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::none, SpeckleKind::independent}) {
      RadarSettings s = beam ? beam_settings() : sharp_settings_of_test();
      s.speckle = speckle;
      const Bin at = bin_near(s, -0.2, 4000);
      Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
      target.size.rcs_dbsm = 40;
      voltages.push_back(scene.difference(s, {target}).voltage(at));
    }
    for (const auto& voltage : voltages) EXPECT_LT(std::abs(voltage / voltages[0] - 1.0), 1e-4) << beam;
  }
}

TEST(TargetEchoes, OfTwoTargetsAddAsVoltages) {
  const TargetScene scene(level_world());
  const RadarSettings s = beam_settings();
  const Bin at = bin_near(s, 0.0, 5000);
  Target a = scene.at_range(at.azimuth_rad, at.range_m, 0);
  a.id = 1;
  a.size.rcs_dbsm = 40;
  Target b = scene.at_range(at.azimuth_rad + s.beam.width_deg * kPi / 360, at.range_m + 3, 0);
  b.id = 2;
  b.size.rcs_dbsm = 40;
  const Difference both = scene.difference(s, {a, b});
  const Difference first = scene.difference(s, {a});
  const Difference second = scene.difference(s, {b});
  for (int k = -10; k <= 10; ++k) {
    const Bin bin{at.azimuth + k, at.range};
    const std::complex<double> sum = first.voltage(bin) + second.voltage(bin);
    EXPECT_LT(std::abs(both.voltage(bin) - sum), 1e-4 * std::abs(sum) + 1e-3 * std::abs(first.voltage(at)))
        << k;
    EXPECT_NEAR(both.power_w(bin) / (first.power_w(bin) + second.power_w(bin)), 1, 1e-9) << k;
  }
}

// Phases that followed the id alone would fix an aspect's mean.
TEST(TargetEchoes, OfAnExtendedTargetKeepTheMeanCrossSection) {
  const TargetScene scene(level_world());
  const RadarSettings s = beam_settings();
  const Bin at = bin_near(s, 0.05, 5000);
  Target target = scene.at_range(at.azimuth_rad, at.range_m, 0);
  target.size.length_m = 30;  // within the bin's response
  target.size.width_m = 8;
  target.heading_deg = 20;
  target.size.rcs_dbsm = 40;
  double sum = 0, squares = 0;
  constexpr int kFrames = 300;
  const double mean = scene.echo_power(s, target, 0);
  for (int frame = 0; frame < kFrames; ++frame) {
    const double power = std::norm(scene.echo_voltage(s, target, static_cast<std::uint64_t>(frame)));
    sum += power / mean;
    squares += power * power / (mean * mean);
  }
  EXPECT_NEAR(sum / kFrames, 1, 4 / std::sqrt(kFrames));
  EXPECT_NEAR(squares / kFrames, 2, 0.8);  // exponential
}

TEST(TargetEchoes, HaveTheSameBitsForAnyThreads) {
  const TargetScene scene(level_world());
  for (const bool beam : {false, true}) {
    const RadarSettings s = beam ? beam_settings() : sharp_settings_of_test();
    std::vector<Target> targets;
    for (std::uint64_t k = 0; k < 50; ++k) {
      targets.push_back(
          scene.at_range(-0.4 + 0.016 * static_cast<double>(k), 1500 + 170.0 * static_cast<double>(k), 3));
      targets.back().id = k + 1;
      targets.back().size.length_m = k % 2 == 0 ? 0 : 60;
    }
    const Frame one = scene.render(s, targets, 1);
    expect_same_bits(one.bins, scene.render(s, targets, 2).bins);
    expect_same_bits(one.bins, scene.render(s, targets, 8).bins);
    expect_same_bits(scene.render(s, {}, 1).bins, scene.bare(s).bins);
  }
}

TEST(TargetEchoes, OfAPartAreThoseOfTheWhole) {
  TargetScene scene(level_world());
  for (const bool beam : {false, true})
    for (const double sector_deg : {90.0, 360.0}) {
      RadarSettings s = beam ? beam_settings() : sharp_settings_of_test();
      s.sector_deg = sector_deg;
      if (beam && sector_deg > 180) s.azimuth_bins = 1024;
      TargetSet set;
      for (std::uint64_t k = 0; k < 200; ++k) {
        set.targets.push_back(
            scene.at_range(0.0315 * static_cast<double>(k), 1020 + 40.0 * static_cast<double>(k), 3));
        set.targets.back().id = k + 1;
        set.targets.back().size.length_m = k % 3 == 0 ? 300 : 0;
      }
      const Frame whole = scene.render(s, set.targets);
      for (const AzimuthRange part :
           {AzimuthRange{0, 8}, AzimuthRange{64, 40}, AzimuthRange{s.azimuth_bins - 16, 16}}) {
        BinBlock expected(part.first, part.count, s.range_bins);
        copy_azimuths(whole.bins, expected);
        expect_same_bits(scene.part(s, set, part).bins, expected);
      }
    }
}

TEST(TargetEchoes, MoveByVelocityAndAcceleration) {
  const TargetScene scene(level_world());
  Target target = scene.at_range(0, 5000, 0);
  target.velocity_m_s = {30, 0, 40};
  target.acceleration_m_s2 = {0, 0, 2};
  target.sim_time_ns = 1'000'000'000;
  const auto start = place_target(scene.world(), target, 0);
  const auto later = place_target(scene.world(), target, 10);
  ASSERT_TRUE(start && later);
  const glm::dvec3 step = later->foot_m - start->foot_m;
  // 300 m east and 500 m north of true north; the tangent plane bends away by millimetres.
  const double north =
      scene.world().frame.north_rad(scene.world().frame.geodetic_from_world({start->foot_m}));
  EXPECT_NEAR(step.x, 300 * std::cos(north) + 500 * std::sin(north), 0.02);
  EXPECT_NEAR(step.z, 500 * std::cos(north) - 300 * std::sin(north), 0.02);
  EXPECT_NEAR(step.y, 0, 1e-3);
  EXPECT_NEAR(later->heading_rad, std::atan2(30.0, 60.0) + north, 1e-4);
}

}  // namespace
}  // namespace obliq::test::targets_test
