// The sea in an image of synthetic aperture: smeared along azimuth by its spectrum, and moved aside by its
// mean. Against sums over the pulses of an aperture.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <vector>

#include "server/radar/doppler/sea_motion.h"
#include "server/radar/doppler/spread_response.h"
#include "tests/support/doppler_scenes.h"

namespace obliq::test::sea_image_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFlight_m_s = 150, kResolution_m = 5;
constexpr int kPulses = 400;    // of an aperture; its response repeats every 400 cells
constexpr double kStep = 0.05;  // cells

double hamming(int n) { return 0.54 + 0.46 * std::cos(2 * kPi * ((n + 0.5) / kPulses - 0.5)); }

/// What an aperture makes of a Gaussian spectrum at each step beside its middle, from -n to n.
std::vector<double> passed(double deviation_cells, int n) {
  std::vector<double> alike(kPulses);
  for (int k = 0; k < kPulses; ++k)
    for (int m = 0; m + k < kPulses; ++m) alike[static_cast<std::size_t>(k)] += hamming(m) * hamming(m + k);
  std::vector<double> power;
  for (int k = -n; k <= n; ++k) {
    double sum = alike[0];
    for (int lag = 1; lag < kPulses; ++lag)
      sum += 2 * alike[static_cast<std::size_t>(lag)] *
             std::exp(-2 * std::pow(kPi * deviation_cells * lag / kPulses, 2)) *
             std::cos(2 * kPi * (k * kStep) * lag / kPulses);
    power.push_back(sum);
  }
  return power;
}

/// Looks north from 1,000 m over a shore that runs north, and flies east.
class SeaImage : public testing::Test {
 protected:
  SeaImage() {
    settings_ = radar_settings(FrustumKind::sweep, {5900, 6100, 6}, {400, 32}, {400, 1});
    settings_.mode = RadarMode::sar;
    settings_.frequency_ghz = 9.4;
    settings_.speckle = SpeckleKind::ground;
    settings_.doppler.resolution_m = kResolution_m;
    settings_.sea.state = 3;
    settings_.sea.shape = 0;
  }
  static TargetScene scene(World world) {
    std::vector<Material> materials = sea_materials();
    materials[1].model = ScatteringModel::constant_gamma;
    materials[1].gamma = 0;
    TargetScene made(std::move(world), kAntenna_m, materials);
    made.pose().settings.bearing_deg = 0;
    made.pose().settings.velocity_east_m_s = kFlight_m_s;
    return made;
  }
  double metres_a_radian() const { return 6000 * std::sqrt(1 - std::pow(kAntenna_m / 6000, 2)); }
  double deviation_cells() const {
    // Azimuth by Doppler: v_r r / v, of a plan's slant range.
    return SeaMotion(settings_).deviation_m_s * 6000 / kFlight_m_s / kResolution_m;
  }

  RadarSettings settings_;
};

TEST_F(SeaImage, SmearsAShoreByItsSpectrum) {
  const TargetScene coast = scene(shore(0));
  const HeightGrid& grid = coast.world().grid;
  const double shore_m = grid.x0_m + grid.cell_m * ((grid.nx - 1) / 2);
  for (const double state : {0.5, 3.0, 5.0})
    for (const double wind_m_s : {0.0, 12.0}) {
      settings_.sea.state = state;
      settings_.atmosphere.wind_m_s = wind_m_s;
      settings_.atmosphere.wind_from_deg = 0;  // it comes closer
      const Frame frame = coast.bare(settings_);
      constexpr int kFar = 2000;
      const std::vector<double> power = passed(deviation_cells(), kFar);
      const double all = std::accumulate(power.begin(), power.end(), 0.0);
      const double moved_m = SeaMotion(settings_).downwind_m_s * metres_a_radian() / kFlight_m_s;
      const auto wanted = [&](double x_m) {
        double sum = 0;
        for (int k = -kFar; k <= kFar; ++k)
          if (x_m - moved_m - k * kStep * kResolution_m < shore_m)
            sum += power[static_cast<std::size_t>(k + kFar)];
        return sum / all;
      };
      double worst = 0;
      const double whole = azimuth_power(frame.bins, 40);
      for (int a = 40; a < 360; ++a) {
        const double x_m = (a + 0.5 - 200) * settings_.azimuth_bin_rad() * metres_a_radian();
        worst = std::max(worst, std::abs(azimuth_power(frame.bins, a) / whole - wanted(x_m)));
      }
      std::printf("    state %.1f, wind %.0f, %.2f cells, aside by %.1f m: worst %.4f\n", state, wind_m_s,
                  deviation_cells(), moved_m, worst);
      EXPECT_LT(worst, 0.01);
    }
}

TEST_F(SeaImage, KeepsThePowerOfOpenSea) {
  RadarSettings map = settings_;
  map.mode = RadarMode::map;
  // The wind comes along the line of sight: it moves the sea aside as far as it can.
  settings_.atmosphere.wind_from_deg = map.atmosphere.wind_from_deg = 0;
  settings_.atmosphere.wind_m_s = map.atmosphere.wind_m_s = 12;
  // What the weights pass of a Gaussian of any width: mean w^2 / (mean w)^2, in cells.
  const double cells = (0.54 * 0.54 + 0.46 * 0.46 / 2) / (0.54 * 0.54);
  for (const double state : {0.1, 3.0, 6.0})
    for (const double speed_m_s : {150.0, 15.0, 3.0}) {
      TargetScene slow = scene(level_world());
      slow.pose().settings.velocity_east_m_s = speed_m_s;
      settings_.sea.state = map.sea.state = state;
      const Frame image = slow.bare(settings_), still = slow.bare(map);
      const double bin_cells = settings_.azimuth_bin_rad() * metres_a_radian() / kResolution_m;
      for (const int a : {3, 200, 390})
        EXPECT_NEAR(azimuth_power(image.bins, a) / azimuth_power(still.bins, a) * bin_cells / cells, 1, 0.01)
            << state << ' ' << speed_m_s << ' ' << a;
    }
}

TEST_F(SeaImage, HasSpeckleOfItsPowerAndTheWeightsGrain) {
  settings_.range_bins = 128;
  for (const double speed_m_s : {150.0, 40.0, 10.0}) {
    TargetScene open = scene(level_world());
    open.pose().settings.velocity_east_m_s = speed_m_s;
    const Frame frame = open.bare(settings_);
    const int n = frame.bins.n_range;
    double of_power = 0, squares = 0, count = 0;
    std::complex<double> alike = 0;
    const auto away = static_cast<int>(
        std::lround(1.5 * kResolution_m / (settings_.azimuth_bin_rad() * metres_a_radian())));
    for (int a = 0; a + away < settings_.azimuth_bins; ++a)
      for (int m = 0; m < n; ++m) {
        const auto voltage = [&](int azimuth) {
          const auto k = static_cast<std::size_t>(azimuth * n + m);
          return std::complex<double>(frame.bins.iq[k]) / std::sqrt(frame.bins.power_w[k]);
        };
        of_power += std::norm(voltage(a));
        squares += std::pow(std::norm(voltage(a)), 2);
        alike += voltage(a + away) * std::conj(voltage(a));
        ++count;
      }
    std::printf("    |V|^2 over P %.3f, <I^2>/<I>^2 %.3f, alike 1.5 cells away %.3f\n", of_power / count,
                squares * count / (of_power * of_power), std::abs(alike) / of_power);
    EXPECT_NEAR(of_power / count, 1, 0.03);
    EXPECT_NEAR(squares * count / (of_power * of_power), 2, 0.1);
    // Of the weights alone.
    double like = 0, weights = 0;
    const double cells = away * settings_.azimuth_bin_rad() * metres_a_radian() / kResolution_m;
    for (int k = 0; k < kPulses; ++k) {
      like += hamming(k) * hamming(k) * std::cos(2 * kPi * cells * ((k + 0.5) / kPulses - 0.5));
      weights += hamming(k) * hamming(k);
    }
    std::printf("    of the weights %.3f\n", like / weights);
    EXPECT_NEAR(std::abs(alike) / of_power, like / weights, 0.1) << speed_m_s;
  }
}

TEST_F(SeaImage, HasTheSameBitsOnAnyNumberOfThreadsInAnyParts) {
  settings_.atmosphere.wind_m_s = 8;
  same_frame_in_any_parts(scene(shore(0)), settings_);
}

TEST_F(SeaImage, OfAnAntennaThatStandsStillIsRefused) {
  TargetScene still = scene(level_world());
  still.pose().settings.velocity_east_m_s = 0;
  const PlanResult planned = plan_frame(still.shared(), snapshot(settings_), still.pose());
  ASSERT_FALSE(planned.plan);
  EXPECT_EQ(planned.errors.front().field, "radar.mode");
}

TEST(SpreadResponseOfAnAperture, IsThatOfOneFrequencyWithoutSpread) {
  RadarSettings s;
  s.mode = RadarMode::sar;
  const DopplerResponse one(s);
  const SpreadResponse none = SpreadResponse::of_aperture(s.doppler, 0, 24);
  for (double u = -25; u < 25; u += 0.13) {
    const double power = std::pow(none.in_phase().at(u), 2) + std::pow(none.ahead().at(u), 2);
    EXPECT_NEAR(power, one.at(u) * one.at(u), 2e-3) << u;
  }
}

}  // namespace
}  // namespace obliq::test::sea_image_test
