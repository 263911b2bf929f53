// The plane that a display shows: its scale, its looks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "server/radar/receiver/looks_law.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/receiver/video.h"
#include "server/radar/simd/kernels.h"
#include "tests/support/small_frames.h"

namespace obliq::test {
namespace {

RadarSettings radar() {
  RadarSettings settings;
  settings.azimuth_bins = 64;
  settings.range_bins = 512;
  settings.r_min_m = 1000;
  settings.r_max_m = 1000 + 30.0 * 512;
  settings.video.floor_auto = false;
  settings.video.floor_db = -150;
  settings.video.span_db = 100;
  return settings;
}

BinBlock video_of(const RadarSettings& settings, BinBlock bins, ReceivedPlanes wanted = {true, true, true}) {
  Receiver(settings, "main", 3).receive(bins, wanted);
  return bins;
}

/// One azimuth bin, all of it of one power.
BinBlock even(const RadarSettings& settings, double power_w) {
  BinBlock bins(0, settings.azimuth_bins, settings.range_bins);
  for (auto& v : bins.iq) v = static_cast<float>(std::sqrt(power_w));
  for (double& p : bins.power_w) p = power_w;
  return bins;
}

/// The coding of the issue, in the library's arithmetic.
int level_of(double power_w, double floor_db, double span_db, int n) {
  if (power_w == 0) return 0;
  const double x = 10 * std::log10(power_w);
  return static_cast<int>(
      std::clamp(1 + std::round((n - 2) * (x - floor_db) / span_db), 1.0, static_cast<double>(n - 1)));
}

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

}  // namespace
}  // namespace obliq::test
