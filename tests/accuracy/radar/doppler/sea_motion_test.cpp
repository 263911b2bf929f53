// What the sea's motion leaves behind a moving target indicator, and its spectrum in trains of pulses,
// against closed forms: a Gaussian spectrum about a mean has the correlation rho(t) = exp(-2 (pi s t)^2) and
// the phase 2 pi f t. A canceller's improvement is 1 / (1 - R1), 3 / (3 - 4 R1 + R2), 10 / (10 - 15 R1 + 6 R2
// - R3), Rk = rho(k T) cos(2 pi k f T) (Skolnik, Radar Handbook, 2008, chapter 2).
#include "server/radar/doppler/sea_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include "server/radar/simd/kernels.h"
#include "tests/support/doppler_scenes.h"
#include "tests/support/same_bits.h"
#include "tests/support/train_scenes.h"

namespace obliq::test::sea_motion_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWavelength_m = 0.299792458 / 9.4;
constexpr double kState = 3, kWind_m_s = 8;
/// Of the wind that raises state 3, 3.16 x 3^0.8 m/s.
constexpr double kDeviation_m_s = 0.101 * 7.6100;
/// Waves of 15.946 mm at 9.81 m/s^2 and 7.2e-5 m^3/s^2, worked out by hand; and 3 % of the wind.
constexpr double kDownwind_m_s = 0.23081 + 0.03 * kWind_m_s;

double improvement_db(int delays, double closing_m_s, double prf_hz) {
  const auto r = [&](int k) {
    const double t = k / prf_hz, deviation_hz = 2 * kDeviation_m_s / kWavelength_m;
    return std::exp(-2 * std::pow(kPi * deviation_hz * t, 2)) *
           std::cos(2 * kPi * 2 * closing_m_s / kWavelength_m * t);
  };
  if (delays == 1) return db(1 / (1 - r(1)));
  if (delays == 2) return db(3 / (3 - 4 * r(1) + r(2)));
  return db(10 / (10 - 15 * r(1) + 6 * r(2) - r(3)));
}

/// Looks north over 5 to 7 km of level sea from 1,000 m.
class SeaMotionTest : public testing::Test {
 protected:
  SeaMotionTest() {
    scene_.pose().settings.bearing_deg = 0;
    settings_ = doppler_radar(RadarMode::mti, 200);
    settings_.pulse.prf_hz = 1000;
    settings_.sea.state = kState;
    settings_.sea.shape = 0;
    settings_.atmosphere.wind_m_s = kWind_m_s;
  }

  void fly_north(double v_m_s) { scene_.pose().settings.velocity_north_m_s = v_m_s; }
  static double middle(const Frame& frame) { return azimuth_power(frame.bins, 100); }
  double found_db(const RadarSettings& s) const {
    RadarSettings map = s;
    map.mode = RadarMode::map;
    return db(middle(scene_.bare(map)) / middle(scene_.bare(s)));
  }

  // Of the sea in the middle of the swath.
  const double cos_e_ = std::sqrt(1 - 1.0 / 36);
  TargetScene scene_{level_world(), kAntenna_m, sea_materials()};
  RadarSettings settings_;
};

TEST(BraggSpeed, IsThatOfWavesOfGravityAndTension) {
  // The least phase speed of waves on water, (4 g T / rho)^(1/4), some 0.23 m/s of waves 1.7 cm long, which
  // 8.8 GHz scatter from; long ones have sqrt(g / k).
  const double slowest_m = 2 * 2 * kPi / std::sqrt(9.81 / 7.2e-5);
  EXPECT_NEAR(bragg_speed_m_s(slowest_m), std::pow(4 * 9.81 * 7.2e-5, 0.25), 1e-6);
  EXPECT_GT(bragg_speed_m_s(slowest_m * 1.1), bragg_speed_m_s(slowest_m));
  EXPECT_GT(bragg_speed_m_s(slowest_m / 1.1), bragg_speed_m_s(slowest_m));
  EXPECT_NEAR(bragg_speed_m_s(6), std::sqrt(9.81 * 3 / (2 * kPi)), 1e-3);
  EXPECT_NEAR(bragg_speed_m_s(kWavelength_m), 0.2308, 1e-4);
}

TEST_F(SeaMotionTest, LeavesBehindACancellerWhatItsSpectrumSays) {
  for (const double wind_from_deg : {0.0, 90.0, 180.0, 60.0})
    for (const int delays : {1, 2, 3}) {
      RadarSettings s = settings_;
      s.atmosphere.wind_from_deg = wind_from_deg;
      s.doppler.canceller = delays;
      const double closing = kDownwind_m_s * std::cos(wind_from_deg * kPi / 180) * cos_e_;
      const double wanted = improvement_db(delays, closing, 1000);
      const double found = found_db(s);
      std::printf("    wind from %.0f, %d: %.2f, closed form %.2f dB\n", wind_from_deg, delays, found,
                  wanted);
      EXPECT_NEAR(found, wanted, 0.05);
      // By the sums of an antenna that turns, ever so slowly.
      RadarSettings turning = s;
      turning.scan_mode = ScanMode::sector;
      turning.scan_rate_deg_s = 0.01;
      EXPECT_NEAR(db(middle(scene_.bare(turning)) / middle(scene_.bare(s))), 0, 0.05);
      const Frame frame = scene_.bare(s);
      double iq = 0, power = 0;
      for (std::size_t k = 0; k < frame.bins.iq.size(); ++k) {
        iq += std::norm(std::complex<double>(frame.bins.iq[k]));
        power += frame.bins.power_w[k];
      }
      EXPECT_NEAR(iq / power, 1, 0.12);
    }
}

TEST_F(SeaMotionTest, IsSeenFromAnAntennaThatMovesToo) {
  RadarSettings s = settings_;
  s.doppler.canceller = 2;
  // With the wind, as fast as the sea: no mean is left; against it: twice the mean.
  fly_north(-kDownwind_m_s);
  EXPECT_NEAR(found_db(s), improvement_db(2, 0, 1000), 0.05);
  fly_north(kDownwind_m_s);
  EXPECT_NEAR(found_db(s), improvement_db(2, 2 * kDownwind_m_s * cos_e_, 1000), 0.05);
  // The notch follows the ground: what the sea does beside it is left. The beam's width counts for little
  // straight ahead.
  s.doppler.clutter_lock = true;
  fly_north(60);
  EXPECT_NEAR(found_db(s), improvement_db(2, kDownwind_m_s * cos_e_, 1000), 0.1);
}

TEST_F(SeaMotionTest, StandsStillWithoutAState) {
  RadarSettings s = settings_;
  s.sea.state = 0;
  EXPECT_EQ(middle(scene_.bare(s)), 0);
  // Without wind it has a width and no mean.
  s.sea.state = kState;
  s.atmosphere.wind_m_s = 0;
  EXPECT_NEAR(found_db(s), improvement_db(s.doppler.canceller, 0, 1000), 0.05);
}

TEST_F(SeaMotionTest, LeavesTheLandBesideItStill) {
  // Sea to the left of the sector's middle, land to the right, of either number.
  for (const bool sea_first : {true, false}) {
    std::vector<Material> materials = two_materials();
    const std::size_t sea = sea_first ? 0 : 1;
    for (Material& material : materials) material.model = ScatteringModel::constant_gamma;
    materials[sea].model = ScatteringModel::sea;
    materials[sea].gamma = 1e-4;
    materials[1 - sea].gamma = 0.1;
    TargetScene coast(shore(sea_first ? 0 : 1), kAntenna_m, materials);
    coast.pose().settings.bearing_deg = 0;
    for (const bool turns : {false, true}) {
      RadarSettings s = settings_;
      if (turns) s.scan_mode = ScanMode::sector;
      if (turns) s.scan_rate_deg_s = 0.01;
      RadarSettings map = s;
      map.mode = RadarMode::map;
      RenderOptions options;
      options.labels = true;
      const auto render_of = [&](const RadarSettings& of) {
        return render(coast.shared(), snapshot(of), coast.pose(), {0, of.azimuth_bins}, options).bins;
      };
      const BinBlock before = render_of(map), after = render_of(s);
      // 12 degrees beside the shore.
      const double closing = kDownwind_m_s * std::cos(12 * kPi / 180) * cos_e_;
      EXPECT_NEAR(db(azimuth_power(before, 40) / azimuth_power(after, 40)), improvement_db(2, closing, 1000),
                  0.05);
      EXPECT_LT(azimuth_power(after, 160), 1e-7 * azimuth_power(before, 160));
      // What is left in the beam that has both is the sea.
      const auto shore = static_cast<std::size_t>(104 * after.n_range + 30);
      EXPECT_EQ(after.labels.material[shore], sea) << turns;
      EXPECT_EQ(before.labels.material[static_cast<std::size_t>(104 * after.n_range + 30)], 1 - sea);
    }
  }
}

TEST_F(SeaMotionTest, HasTheSameBitsOnAnyNumberOfThreadsAndInAnyParts) {
  fly_north(30);
  for (const bool lock : {false, true}) {
    RadarSettings s = settings_;
    s.doppler.clutter_lock = lock;
    s.sea.shape = 1;
    same_frame_in_any_parts(scene_, s);
  }
}

// Over hills of water lanes side by side see quite different grazing angles: tables are read in both ways.
TEST_F(SeaMotionTest, HasTheSameBitsWithAnyInstructionSet) {
  const World hills = made_world(
      9000, 70, [](double x, double z) { return 60 + 50 * std::sin(x / 400) * std::cos(z / 300); });
  for (const bool is_rough : {false, true})
    for (const RadarMode mode : {RadarMode::map, RadarMode::mti}) {
      TargetScene scene = is_rough ? TargetScene(World(hills), 150, sea_materials())
                                   : TargetScene(level_world(), kAntenna_m, sea_materials());
      RadarSettings s = settings_;
      s.mode = mode;
      s.r_min_m = is_rough ? 200 : 5000;
      s.sea.shape = 1;
      const Frame first = scene.bare(s);
      for (const Kernels& kernels : all_kernels()) {
        use_kernels(kernels);
        const Frame again = scene.bare(s);
        EXPECT_TRUE(same_bits(first.bins.power_w, again.bins.power_w)) << kernels.name;
        EXPECT_TRUE(same_bits(first.bins.iq, again.bins.iq)) << kernels.name;
      }
      use_kernels(all_kernels().back());
    }
}

TEST_F(SeaMotionTest, IsNotThatOfWoodsAsWell) {
  // Of a material that moves in the wind and is sea, the sea's motion alone counts, once.
  std::vector<Material> both = sea_materials();
  both[0].wind = true;
  TargetScene windy{level_world(), kAntenna_m, both};
  windy.pose().settings.bearing_deg = 0;
  RadarSettings s = train_settings();
  s.doppler.pulses = 16;
  s.pulse.prf_hz = 1000;
  s.sea.state = kState;
  s.sea.shape = 0;
  s.atmosphere.wind_m_s = kWind_m_s;
  EXPECT_TRUE(same_train(train_of(scene_, s), train_of(windy, s)));
}

TEST_F(SeaMotionTest, IsInTrainsOfPulses) {
  RadarSettings s = train_settings();
  s.doppler.pulses = 16;
  s.pulse.prf_hz = 1000;
  s.speckle = SpeckleKind::independent;
  s.sea.state = kState;
  s.sea.shape = 0;
  s.atmosphere.wind_m_s = kWind_m_s;
  for (const double wind_from_deg : {0.0, 180.0}) {
    s.atmosphere.wind_from_deg = wind_from_deg;
    double before = 0, after[3] = {};
    std::vector<double> left(static_cast<std::size_t>(s.range_bins)), fourth = left;  // by range
    std::complex<double> pairs = 0;
    int n = 0;  // of each range
    for (std::uint64_t draw = 1; draw <= 60; ++draw) {
      const PulseTrain train = train_of(scene_, s, {.draw = draw});
      for (int p = 0; p + 2 < train.n_pulses; ++p, ++n)
        for (int m = 0; m < train.n_range; ++m) {
          const std::complex<double> x[] = {sample(train, p, m), sample(train, p + 1, m),
                                            sample(train, p + 2, m)};
          before += std::norm(x[0]);
          pairs += x[1] * std::conj(x[0]);
          after[1] += std::norm(x[1] - x[0]);
          after[2] += std::norm(x[2] - 2.0 * x[1] + x[0]);
          left[static_cast<std::size_t>(m)] += std::norm(x[1] - x[0]);
          fourth[static_cast<std::size_t>(m)] += std::pow(std::norm(x[1] - x[0]), 2);
        }
    }
    const double closing = (wind_from_deg == 0 ? 1 : -1) * kDownwind_m_s * cos_e_;
    const double mean_m_s = std::arg(pairs) / (2 * kPi) * 1000 * kWavelength_m / 2;
    const double deviation_m_s =
        std::sqrt(-std::log(std::abs(pairs) / before) / 2) / kPi * 1000 * kWavelength_m / 2;
    const double single = db(2 * before / after[1]), twice = db(6 * before / after[2]);
    // What is left is Gaussian: sums of rows.
    double contrast = 0;
    for (std::size_t m = 0; m < left.size(); ++m)
      contrast += fourth[m] * n / (left[m] * left[m]) / static_cast<double>(left.size());
    std::printf(
        "    mean %.3f (%.3f), deviation %.3f (%.3f) m/s; %.2f (%.2f), %.2f (%.2f) dB; contrast %.2f\n",
        mean_m_s, closing, deviation_m_s, kDeviation_m_s, single, improvement_db(1, closing, 1000), twice,
        improvement_db(2, closing, 1000), contrast);
    EXPECT_NEAR(mean_m_s, closing, 0.03);
    EXPECT_NEAR(deviation_m_s, kDeviation_m_s, 0.03);
    EXPECT_NEAR(single, improvement_db(1, closing, 1000), 0.3);
    EXPECT_NEAR(twice, improvement_db(2, closing, 1000), 0.4);
    EXPECT_NEAR(contrast, 2, 0.25);
  }
}

}  // namespace
}  // namespace obliq::test::sea_motion_test
