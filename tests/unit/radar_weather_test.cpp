// Attenuation against the Recommendations' published numbers, rain's echo against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "server/radar/receiver/noise.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/render.h"
#include "tests/support/scenes.h"
#include "tests/support/small_frames.h"
#include "tests/support/sources.h"

namespace obliq::test {
namespace {

// ITU-R P.838-3, Table 5, and the program itur 0.4.0 at other frequencies.
TEST(Rain, AttenuatesAsP838Says) {
  const auto h = Polarisation::horizontal;
  const auto v = Polarisation::vertical;
  const auto k = [](double f, Polarisation p) { return rain_attenuation_db_km(1, f, p); };
  const auto alpha = [&](double f, Polarisation p) {
    return std::log10(rain_attenuation_db_km(10, f, p) / k(f, p));
  };
  EXPECT_NEAR(k(10, h), 0.012167, 5e-7);
  EXPECT_NEAR(k(10, v), 0.011292, 5e-7);
  EXPECT_NEAR(alpha(10, h), 1.25710, 5e-6);
  EXPECT_NEAR(alpha(10, v), 1.21565, 5e-6);
  EXPECT_NEAR(rain_attenuation_db_km(16, 9.4, h), 0.3310, 5e-5);
  EXPECT_NEAR(rain_attenuation_db_km(16, 10, h), 0.3971, 5e-5);
  EXPECT_NEAR(rain_attenuation_db_km(16, 35, h), 4.1449, 5e-5);
  EXPECT_EQ(rain_attenuation_db_km(0, 10, h), 0);
}

// ITU-R P.676-12 by itur 0.4.0: 1013.25 hPa, 7.5 g/m^3, 288.15 K.
TEST(Gas, AttenuatesAsP676Says) {
  EXPECT_NEAR(gas_attenuation_db_km(10), 0.01420, 5e-6);
  EXPECT_NEAR(gas_attenuation_db_km(35), 0.1015, 5e-5);
  EXPECT_NEAR(gas_attenuation_db_km(60), 14.7783166, 1e-6);
  EXPECT_NEAR(gas_attenuation_db_km(22.2), 0.191661037, 1e-8);
}

TEST(Rain, IsLeftAboveItsTop) {
  RadarSettings settings;
  settings.atmosphere.rain_mm_h = 16;
  settings.atmosphere.rain_top_m = 2200;
  EXPECT_NEAR(path_loss_db_km(settings, {1200, 200}), 0.3971, 5e-5);
  EXPECT_NEAR(path_loss_db_km(settings, {8200, 200}), 0.3971 / 4, 2e-5);
  EXPECT_EQ(path_loss_db_km(settings, {8200, 2300}), 0);
  EXPECT_NEAR(path_power_factor(0.3971, 37000), std::pow(10, -0.2 * 0.3971 * 37), 1e-12);
}

TEST(Rain, EchoesAsItsVolume) {
  RadarSettings settings;
  settings.atmosphere.rain_mm_h = 10;
  settings.atmosphere.rain_top_m = 3000;
  settings.power_w = 50e3;
  settings.gain_db = 33;
  settings.r_min_m = 2000;
  settings.r_max_m = 20000;
  settings.range_bins = 100;
  const AirView air{1500, 300};
  const std::vector<double> rain_w = rain_echo_power_w(settings, air);
  ASSERT_EQ(rain_w.size(), 100u);
  // Z = 200 R^1.6 = 39.0 dBZ at 10 mm/h; eta = pi^5 |K|^2 Z / lambda^4.
  const double lambda = 0.0299792458;
  const double z = 200 * std::pow(10, 1.6);
  EXPECT_NEAR(10 * std::log10(z), 39.0, 0.02);
  const double eta = std::pow(std::numbers::pi, 5) * 0.93 * z * 1e-18 / std::pow(lambda, 4);
  EXPECT_NEAR(rain_reflectivity_m2_m3(10, lambda) / eta, 1, 1e-12);
  for (const int bin : {0, 40, 99}) {
    const double r = 2000 + 180 * (bin + 0.5);
    // The shell between ground and top: between sines of elevation -1200 / r and 1500 / r.
    const double volume_m3 = r * r * (120 * std::numbers::pi / 180 / 1024) * (2700 / r) * 180;
    const double constant = 50e3 * std::pow(10, 6.6) * lambda * lambda / std::pow(4 * std::numbers::pi, 3);
    const double attenuation =
        std::pow(10, -0.2 * rain_attenuation_db_km(10, 10, Polarisation::horizontal) * r / 1000);
    EXPECT_NEAR(
        rain_w[static_cast<std::size_t>(bin)] / (constant * eta * volume_m3 / std::pow(r, 4) * attenuation),
        1, 1e-9)
        << bin;
  }
}

class WeatherOf : public testing::TestWithParam<NamedSource> {};

TEST_P(WeatherOf, AttenuatesEchoesAndAddsItsOwn) {
  RadarSettings settings = small_frame(GetParam().kind);
  const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const Pose pose = pose_over_origin(scene->world(), 1400);
  const auto rendered = [&](const RadarSettings& s) {
    return render(scene, snapshot(s), pose, {0, s.azimuth_bins}).bins;
  };
  const BinBlock dry = rendered(settings);
  settings.atmosphere.gas = true;
  settings.frequency_ghz = 10;
  const BinBlock gas = rendered(settings);
  for (std::size_t k = 0; k < dry.power_w.size(); ++k) {
    const double r_km = (1500 + 4500.0 / 64 * (static_cast<double>(k % 64) + 0.5)) / 1000;
    const double factor = std::pow(10, -0.2 * gas_attenuation_db_km(10) * r_km);
    ASSERT_NEAR(gas.power_w[k], dry.power_w[k] * factor, 1e-9 * dry.power_w[k]);
    ASSERT_NEAR(std::norm(gas.iq[k]), std::norm(dry.iq[k]) * factor, 1e-5 * std::norm(dry.iq[k]));
  }
  settings.atmosphere.rain_mm_h = 50;
  settings.power_w = 0;  // nothing sent, no rain seen
  for (const std::complex<float> v : rendered(settings).iq) ASSERT_EQ(v, 0.0F);
  settings.power_w = 1;
  const BinBlock wet = rendered(settings);
  // The antenna is below the rain's top, so all of each path is in it. Less the ground's echo rain is left.
  const double loss_db_km = path_loss_db_km(settings, {1400, 0});
  double ratio = 0;
  for (std::size_t k = 0; k < wet.power_w.size(); ++k) {
    const double r_m = 1500 + 4500.0 / 64 * (static_cast<double>(k % 64) + 0.5);
    const double factor = path_power_factor(loss_db_km, r_m);
    const double rain_w = wet.power_w[k] - factor * dry.power_w[k];
    ASSERT_GT(rain_w, 0) << k;
    const auto rain = std::complex<double>(wet.iq[k]) - std::sqrt(factor) * std::complex<double>(dry.iq[k]);
    ratio += std::norm(rain) / rain_w;
  }
  const auto n = static_cast<double>(wet.power_w.size());
  EXPECT_NEAR(ratio / n, 1, 5 / std::sqrt(n));
}

INSTANTIATE_TEST_SUITE_P(Sources, WeatherOf, testing::ValuesIn(kEverySource),
                         source_name<testing::TestParamInfo<NamedSource>>);

}  // namespace
}  // namespace obliq::test
