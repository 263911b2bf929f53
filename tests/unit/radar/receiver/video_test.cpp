// The plane that a display shows: its scale, its looks.
// Attenuation against the Recommendations' published numbers, rain's echo against its closed form.
// Noise behind a pulse: its power, and its correlation in range.
#include "server/radar/receiver/video.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "server/radar/beam/point_response.h"
#include "server/radar/receiver/looks_law.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/render.h"
#include "server/radar/simd/kernels.h"
#include "tests/support/scenes.h"
#include "tests/support/silent_radar.h"
#include "tests/support/sources.h"
#include "tests/unit/radar/receiver/video_fixture.h"

namespace obliq::test::video_test {
namespace {

TEST(Video, OfOneLookIsTheLogarithmOfIq) {
  const RadarSettings settings = radar();
  BinBlock bins(0, settings.azimuth_bins, settings.range_bins);
  for (std::size_t k = 0; k < bins.iq.size(); ++k)
    bins.iq[k] = k % 7 == 0 ? 0.0F : std::polar(std::pow(10.0F, -9.0F + 5e-4F * static_cast<float>(k)), 1.0F);
  const BinBlock out = video_of(settings, bins);
  ASSERT_EQ(out.video8.size(), bins.iq.size());
  ASSERT_EQ(out.video16.size(), bins.iq.size());
  for (std::size_t k = 0; k < bins.iq.size(); ++k) {
    const double power = std::norm(std::complex<double>(bins.iq[k]));
    ASSERT_EQ(out.video8[k], level_of(power, -150, 100, 256)) << k;
    ASSERT_EQ(out.video16[k], level_of(power, -150, 100, 65536)) << k;
  }
}

TEST(Video, HasNoughtForNothingOneForWhatIsBelowTheFloorAndATop) {
  const RadarSettings settings = radar();
  EXPECT_EQ(video_of(settings, even(settings, 0)).video8[5], 0);
  EXPECT_EQ(video_of(settings, even(settings, 1e-20)).video8[5], 1);
  EXPECT_EQ(video_of(settings, even(settings, 1e-36)).video16[5], 1);
  EXPECT_EQ(video_of(settings, even(settings, 1)).video8[5], 255);
  EXPECT_EQ(video_of(settings, even(settings, 1)).video16[5], 65535);
}

TEST(Video, OfSeveralLooksScattersAsTheirMean) {
  RadarSettings settings = radar();
  settings.video.span_db = 60;
  for (const int looks : {2, 3, 10, 100, 1024}) {
    settings.video.looks = looks;
    // 16 bits in 60 dB: a step is 0.02 % of the power, rounding a fifth of a thousandth of the mean.
    const BinBlock out = video_of(settings, even(settings, 1e-12), {false, false, true});
    double sum = 0, squares = 0;
    for (const std::uint16_t level : out.video16) {
      const double power = 1e12 * std::pow(10, (-150 + (level - 1) * 60 / 65534.0) / 10);
      sum += power;
      squares += power * power;
    }
    const auto n = static_cast<double>(out.video16.size());
    const double mean = sum / n;
    const double contrast = std::sqrt(squares / n - mean * mean) / mean;
    EXPECT_NEAR(mean, 1, 5 / std::sqrt(n * looks) + 1e-4) << looks;
    // The deviation's own: sqrt((kurtosis - 1) / 4n), kurtosis 3 + 6/N.
    EXPECT_NEAR(contrast * std::sqrt(looks), 1, 5 * std::sqrt((2 + 6.0 / looks) / (4 * n)) + 1e-3) << looks;
    EXPECT_TRUE(out.video8.empty());
  }
}

/// Of N looks P(mean < x) = 1 - exp(-N x) times the sum of (N x)^k / k!, k below N (Erlang).
double erlang(int looks, double x) {
  double term = std::exp(-looks * x), sum = 0;
  for (int k = 0; k < looks; ++k) {
    sum += term;
    term *= looks * x / (k + 1);
  }
  return 1 - sum;
}

TEST(Video, OfSeveralLooksIsGammaDistributed) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> part(0, std::sqrt(0.5));
  for (const int looks : {2, 4, 16, 64}) {
    const LooksLaw law(looks);
    std::vector<double> mean(80000);
    for (double& x : mean) {
      const double re = part(random);
      x = law.mean(re, part(random));
    }
    std::ranges::sort(mean);
    const auto n = static_cast<double>(mean.size());
    double greatest = 0;
    for (std::size_t k = 0; k < mean.size(); ++k)
      greatest = std::max(greatest, std::abs(erlang(looks, mean[k]) - (static_cast<double>(k) + 0.5) / n));
    EXPECT_LT(greatest, 1.95 / std::sqrt(n)) << looks;
  }
}

TEST(Video, OfLooksHoldsForAnyVoltage) {
  const LooksLaw law(1024);
  for (const double re : {0.0, -0.299, 1e-200, 7.9, 1e6})
    for (const double im : {0.0, 1e-9, -1e6}) {
      EXPECT_GT(law.mean(re, im), 0.5) << re << ", " << im;
      EXPECT_LT(law.mean(re, im), 2) << re << ", " << im;
    }
}

TEST(Video, HasTheSameBitsInEveryInstructionSet) {
  std::vector<std::int32_t> expected;
  std::vector<double> power(512);
  for (std::size_t k = 0; k < power.size(); ++k) power[k] = std::exp(0.013 * static_cast<double>(k) - 3);
  for (const Kernels& kernels : all_kernels()) {
    std::vector<std::int32_t> levels(512);
    kernels.video_levels({512, power.data(), -3, 100, 65535, levels.data()});
    if (expected.empty()) expected = levels;
    EXPECT_EQ(levels, expected) << kernels.name;
  }
}

TEST(Video, OfLooksStandsOverNoiseGainAndStc) {
  RadarSettings settings = radar();
  settings.receiver.noise = true;
  settings.video.looks = 1024;
  settings.receiver.gain_db = 12;
  settings.receiver.stc_range_m = 16000;
  settings.range_normalisation = true;
  settings.video.floor_db = -50;
  const double echo_w = 3 * noise_power_w(settings);
  const BinBlock out = video_of(settings, even(settings, echo_w), {false, false, true});
  for (const int bin : {0, 100, 400}) {
    const double range_m = 1000 + 30 * (bin + 0.5);
    const double expected_db = 10 * std::log10(4 * noise_power_w(settings)) + 12 +
                               40 * std::log10(std::min(1.0, range_m / 16000)) + 40 * std::log10(range_m);
    double sum_db = 0;
    for (int a = 0; a < settings.azimuth_bins; ++a)
      sum_db +=
          -50 + (out.video16[static_cast<std::size_t>(a * settings.range_bins + bin)] - 1) * 100 / 65534.0;
    // 64 bins of 1024 looks: a deviation of 0.017 dB.
    EXPECT_NEAR(sum_db / settings.azimuth_bins, expected_db, 0.09) << bin;
  }
}

TEST(Video, FindsItsFloorFromTheSettingsAlone) {
  RadarSettings settings = radar();
  settings.video.floor_auto = true;
  settings.power_w = 50e3;
  settings.gain_db = 33;
  settings.frequency_ghz = 9.4;
  // K G^2 gamma w h delta / r^4, h = r / 20, less 20 dB.
  const double lambda = 299792458.0 / 9.4e9;
  const double r = settings.r_max_m;
  const double power = 50e3 * std::pow(10, 6.6) * lambda * lambda / std::pow(4 * std::numbers::pi, 3) *
                       std::pow(10, -1.5) * (120 * std::numbers::pi / 180 / 64) * (r / 20) * 30 /
                       std::pow(r, 4);
  EXPECT_EQ(video_floor_db(settings), std::floor(10 * std::log10(power) - 20));
  settings.range_normalisation = true;
  EXPECT_EQ(video_floor_db(settings), std::floor(10 * std::log10(power * std::pow(r, 4)) - 20));
  settings.range_normalisation = false;
  settings.receiver.noise = true;
  EXPECT_EQ(video_floor_db(settings), std::floor(10 * std::log10(noise_power_w(settings))));
  // The gain knob moves the picture, not the scale.
  settings.receiver.gain_db = 30;
  EXPECT_EQ(video_floor_db(settings), std::floor(10 * std::log10(noise_power_w(settings))));
  settings.receiver.noise = false;
  settings.power_w = 0;
  EXPECT_EQ(video_floor_db(settings), -400);
}

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
}  // namespace obliq::test::video_test
