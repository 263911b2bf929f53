// Noise, gain, sensitivity time control and converter against closed forms and published numbers.
#include "server/radar/receiver/receiver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "server/radar/receiver/noise.h"
#include "server/radar/render.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"
#include "tests/support/silent_radar.h"
#include "tests/support/sources.h"

namespace obliq::test::receiver_test {
namespace {

/// |sum a conj(b)| / sqrt(sum |a|^2 sum |b|^2).
double correlation(const std::vector<std::complex<float>>& a, const std::vector<std::complex<float>>& b) {
  std::complex<double> cross = 0;
  double aa = 0, bb = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::complex<double> x(a[k]), y(b[k]);
    cross += x * std::conj(y);
    aa += std::norm(x);
    bb += std::norm(y);
  }
  return std::abs(cross) / std::sqrt(aa * bb);
}

TEST(Decibels, AgreeWithTheLibrary) {
  for (const double db : {-200.0, -30.0, -0.001, 0.0, 1e-9, 3.0, 10.0, 199.0}) {
    EXPECT_NEAR(ratio_of_db(db) / std::pow(10, db / 10), 1, 1e-13) << db;
    EXPECT_NEAR(db_of_ratio(ratio_of_db(db)), db, 1e-12 * std::max(1.0, std::abs(db))) << db;
  }
  EXPECT_EQ(ratio_of_db(0), 1);
}

// MathWorks, pages of radareqsnr and noisepow (Phased Array System Toolbox); the numbers are theirs, to the
// digits that they print.
TEST(RadarEquation, GivesTheSignalToNoiseRatiosThatMathWorksPrints) {
  const auto snr_db = [](double power_w, double gain_db, double frequency_hz, double loss_db,
                         double cross_section_m2, double range_m, double temperature_k, double pulse_s) {
    return db_of_ratio(
        echo_power_w(power_w, gain_db, kSpeedOfLight_m_s / frequency_hz, loss_db, cross_section_m2, range_m) /
        noise_power_w(temperature_k, {1 / pulse_s, 1}));
  };
  EXPECT_NEAR(snr_db(1e6, 20, 1e9, 0, 1, 50e3, 290, 0.2e-6), 5.5868, 5e-5);
  EXPECT_NEAR(snr_db(1e6, 40, 10e9, 3, 0.5, 100e3, 300, 1e-6), 14.3778, 5e-5);
  // surfclutterrcs, radareqsnr: NRCS 1, 1 km, 1 x 3 deg, grazing 10 deg; the patch, and its CNR.
  const double degree = std::numbers::pi / 180;
  const double patch_m2 = 1 / std::sin(10 * degree) * (1 * degree) * (3 * degree) * 1000 * 1000;
  EXPECT_NEAR(patch_m2, 5262.7, 0.05);
  EXPECT_NEAR(snr_db(5e3, 20, kSpeedOfLight_m_s / 0.01, 0, patch_m2, 1000, 290, 10e-6), 75.2006, 1e-4);
}

TEST(NoisePower, IsThatOfNoisepow) {
  // 10 kHz, noise figure 1 dB, reference temperature 300 K: 5.2144e-17 W.
  EXPECT_NEAR(noise_power_w(system_temperature_k(1, 300, 300), {10e3, 1}), 5.2144e-17, 5e-22);
}

TEST(NoisePower, OfASilentRadarIsInItsBinsWhateverItsLosses) {
  RadarSettings settings = noisy();
  // k (290 + 290 (10^0.4 - 1)) c / (2 x 30 m)
  const double expected = 1.380649e-23 * 290 * std::pow(10, 0.4) * kSpeedOfLight_m_s / 60;
  EXPECT_NEAR(noise_power_w(settings) / expected, 1, 1e-12);
  const BinBlock bins = received(settings, silence(settings));
  // Each |n|^2 is exponential: the mean of 65,536 is off by 1/256 at one standard deviation; five allowed.
  EXPECT_NEAR(mean_power(bins) / expected, 1, 5.0 / 256);
  settings.receiver.loss_db = 10;
  EXPECT_TRUE(same_bits(received(settings, silence(settings)).iq, bins.iq));
}

TEST(Noise, IsExponentialInPowerAndEvenInPhase) {
  const RadarSettings settings = noisy();
  const BinBlock bins = received(settings, silence(settings));
  std::vector<double> power;
  std::complex<double> mean = 0, mean_square = 0;
  for (const std::complex<float> v : bins.iq) {
    const std::complex<double> w = std::complex<double>(v) / std::sqrt(noise_power_w(settings));
    power.push_back(std::norm(w));
    mean += w;
    mean_square += w * w;
  }
  std::ranges::sort(power);
  const auto n = static_cast<double>(power.size());
  double greatest = 0;  // Kolmogorov and Smirnov
  for (std::size_t k = 0; k < power.size(); ++k) {
    const double law = 1 - std::exp(-power[k]);
    const auto rank = static_cast<double>(k);
    greatest = std::max({greatest, std::abs(law - rank / n), std::abs(law - (rank + 1) / n)});
  }
  EXPECT_LT(greatest, 1.95 / std::sqrt(n));  // exceeded once in a thousand laws that hold
  EXPECT_LT(std::abs(mean) / n, 5 / std::sqrt(n));
  EXPECT_LT(std::abs(mean_square) / n, 5 / std::sqrt(n));
  // False alarms: exp(-threshold) of the bins are above a threshold.
  for (const double threshold : {1.0, 3.0, 6.0}) {
    const auto above = static_cast<double>(power.end() - std::ranges::lower_bound(power, threshold));
    const double expected = n * std::exp(-threshold);
    EXPECT_NEAR(above, expected, 5 * std::sqrt(expected)) << threshold;
  }
}

TEST(Noise, IsAnotherInEachFrameSeedAndRadarAndRepeats) {
  RadarSettings settings = noisy();
  const BinBlock first = received(settings, silence(settings), 7);
  const double unrelated = 5 / std::sqrt(static_cast<double>(first.iq.size()));
  EXPECT_TRUE(same_bits(received(settings, silence(settings), 7).iq, first.iq));
  EXPECT_LT(correlation(received(settings, silence(settings), 8).iq, first.iq), unrelated);
  EXPECT_LT(correlation(received(settings, silence(settings), 7, "other").iq, first.iq), unrelated);
  settings.receiver.noise_seed = 2;
  EXPECT_LT(correlation(received(settings, silence(settings), 7).iq, first.iq), unrelated);
}

TEST(Noise, OfAWedgeIsThatOfTheWholeFrame) {
  const RadarSettings settings = noisy();
  const BinBlock whole = received(settings, silence(settings));
  BinBlock wedge = received(settings, BinBlock(16, 8, settings.range_bins));
  BinBlock copied(16, 8, settings.range_bins);
  copy_azimuths(whole, copied);
  EXPECT_TRUE(same_bits(wedge.iq, copied.iq));
}

TEST(Noise, HasTheSameBitsInEveryInstructionSet) {
  constexpr int kBins = 100;
  constexpr std::size_t kRoom = 128;
  const std::vector<double> taps{0.25, 1, 0.5};
  std::vector<double> expected_re, expected_im;
  for (const Kernels& kernels : all_kernels()) {
    std::vector<double> re(kRoom), im(kRoom), out_re(kRoom), out_im(kRoom);
    kernels.white_noise({0x1234567890abcdefu, std::uint64_t{77} << 32, kBins + 2, re.data(), im.data()});
    kernels.filter_row({kBins, 3, taps.data(), re.data(), out_re.data()});
    kernels.filter_row({kBins, 3, taps.data(), im.data(), out_im.data()});
    out_re.resize(kBins);
    out_im.resize(kBins);
    EXPECT_NEAR(out_re[50], 0.25 * re[50] + re[51] + 0.5 * re[52], 1e-14) << kernels.name;
    if (expected_re.empty()) {
      expected_re = out_re;
      expected_im = out_im;
    }
    EXPECT_EQ(out_re, expected_re) << kernels.name;
    EXPECT_EQ(out_im, expected_im) << kernels.name;
  }
}

/// One azimuth bin with the same echo everywhere.
BinBlock echoes(const RadarSettings& settings, std::complex<float> voltage) {
  BinBlock bins(0, 1, settings.range_bins);
  std::ranges::fill(bins.iq, voltage);
  std::ranges::fill(bins.power_w, std::norm(std::complex<double>(voltage)));
  return bins;
}

// An image's train has PRF lambda r / (2 v resolution) pulses abeam: 0.71 s, 710 pulses at 20 km, 3 m, 150
// m/s, 9.4 GHz, 1 kHz. Hamming's weights lose 1.3444 dB (Harris 1978).
TEST(Receiver, NoiseOfAnImageIsThatOfItsTrainsPulses) {
  RadarSettings settings = radar_settings(FrustumKind::sweep, {10'000, 30'000, 4}, {64, 1000});
  settings.receiver.noise = true;
  const double map_w = noise_power_w(settings);
  settings.mode = RadarMode::sar;
  settings.frequency_ghz = 9.4;
  settings.doppler.resolution_m = 3;
  const AirView abeam{1000, 0, 0, 150};
  const double loss = std::pow(10, 0.13444);
  const auto pulses_at = [](double range_m) {
    return 1000 * (299792458.0 / 9.4e9) * range_m / (2 * 150 * 3);
  };
  EXPECT_NEAR(pulses_at(20'000), 709, 1);
  for (const double range_m : {10'000.0, 20'000.0, 30'000.0})
    EXPECT_NEAR(noise_power_w(settings, abeam, range_m) / (map_w * loss / pulses_at(range_m)), 1, 1e-4);
  // Half as fast, half the noise; twice the PRF, too; doppler.pulses has no part in it.
  EXPECT_NEAR(noise_power_w(settings, {1000, 0, 0, 75}) / noise_power_w(settings, abeam), 0.5, 1e-9);
  RadarSettings other = settings;
  other.pulse.prf_hz = 2000;
  other.doppler.pulses = 999;
  EXPECT_NEAR(noise_power_w(other, abeam) / noise_power_w(settings, abeam), 0.5, 1e-9);
  other.pulse.prf_hz = 1;  // not one pulse
  EXPECT_EQ(noise_power_w(other, abeam, 20'000), map_w);
  // And it is in the bins: 64 x 100 draws a tenth of the swath.
  const Receiver receiver(settings, "main", 1, abeam);
  EXPECT_EQ(receiver.noise_power_w(), noise_power_w(settings, abeam, 20'000));
  EXPECT_EQ(receiver.video_scale().floor_db, std::floor(10 * std::log10(receiver.noise_power_w())));
  BinBlock bins = silence(settings);
  receiver.receive(bins, {});
  for (const std::size_t first : {0u, 500u, 900u}) {
    double sum = 0, expected = 0;
    for (std::size_t k = first; k < first + 100; ++k) {
      for (std::size_t a = 0; a < 64; ++a) sum += std::norm(std::complex<double>(bins.iq[a * 1000 + k]));
      expected += 64 * map_w * loss / pulses_at(10'000 + 20.0 * (static_cast<double>(k) + 0.5));
    }
    EXPECT_NEAR(sum / expected, 1, 0.05) << first;  // four standard deviations
  }
}

TEST(Receiver, SwitchedOffLeavesEveryBit) {
  RadarSettings settings = noisy();
  settings.receiver.noise = false;
  settings.range_normalisation = true;  // then of the samples
  BinBlock bins = echoes(settings, {1e-9F, -3e-9F});
  const BinBlock before = bins;
  const Receiver receiver(settings, "main", 1);
  EXPECT_FALSE(receiver.is_on());
  receiver.receive(bins, {});
  EXPECT_TRUE(same_bits(bins.iq, before.iq));
  EXPECT_TRUE(same_bits(bins.power_w, before.power_w));
}

TEST(Receiver, LossesAndGainAreThoseOfTheSettings) {
  RadarSettings settings = noisy();
  settings.receiver.noise = false;
  settings.receiver.loss_db = 6;
  settings.receiver.gain_db = 20;
  const BinBlock bins = received(settings, echoes(settings, {3e-9F, 4e-9F}));
  const double volts = 5e-9 * std::pow(10, (20 - 6) / 20.0);
  EXPECT_NEAR(std::abs(std::complex<double>(bins.iq[5])) / volts, 1, 1e-6);  // float
  // The power plane: losses, no gain.
  EXPECT_NEAR(bins.power_w[5] / (25e-18 * std::pow(10, -0.6)), 1, 1e-6);
}

TEST(Receiver, RangeNormalisationComesLast) {
  RadarSettings settings = noisy();
  settings.range_normalisation = true;
  EXPECT_FALSE(normalises_samples(settings));
  const BinBlock bins = received(settings, silence(settings));
  RadarSettings plain = settings;
  plain.range_normalisation = false;
  const BinBlock as_it_is = received(plain, silence(plain));
  for (const int bin : {0, 500, 1023}) {
    const double range_m = 1000 + 30 * (bin + 0.5);
    const std::size_t k = static_cast<std::size_t>(bin);
    EXPECT_NEAR(std::abs(std::complex<double>(bins.iq[k])) /
                    (std::abs(std::complex<double>(as_it_is.iq[k])) * range_m * range_m),
                1, 1e-6);
  }
}

TEST(Stc, KeepsATargetsLevelAtAllRanges) {
  ReceiverSettings receiver;
  receiver.stc_range_m = 20000;
  receiver.stc_power = 4;
  receiver.stc_db = 200;
  for (const double range_m : {100.0, 2000.0, 19999.0})
    EXPECT_NEAR(stc_gain_db(receiver, range_m), 40 * std::log10(range_m / 20000), 1e-9);
  EXPECT_EQ(stc_gain_db(receiver, 20000), 0);
  EXPECT_EQ(stc_gain_db(receiver, 30000), 0);
  receiver.stc_db = 30;
  EXPECT_EQ(stc_gain_db(receiver, 100), -30);
  EXPECT_EQ(stc_gain_db(receiver, 0), -30);

  // In bins: echoes of 1 / r^4 come out alike within stc_range_m.
  RadarSettings settings = noisy();
  settings.receiver = receiver;
  settings.receiver.stc_db = 200;
  BinBlock bins(0, 1, settings.range_bins);
  for (int k = 0; k < settings.range_bins; ++k) {
    const double range_m = 1000 + 30 * (k + 0.5);
    bins.iq[static_cast<std::size_t>(k)] = static_cast<float>(1e6 / (range_m * range_m));
  }
  bins = received(settings, bins);
  const float level = bins.iq[0].real();
  EXPECT_NEAR(level, 1e6 / (20000.0 * 20000.0), 1e-6 * static_cast<double>(level));
  for (int k = 0; k < 600; ++k)
    EXPECT_NEAR(bins.iq[static_cast<std::size_t>(k)].real() / level, 1, 1e-6) << k;
}

TEST(Stc, LowersNoiseAndEchoesAlike) {
  RadarSettings settings = noisy();
  const BinBlock before = received(settings, silence(settings));
  settings.receiver.stc_range_m = 20000;
  const BinBlock after = received(settings, silence(settings));
  const double ratio = std::norm(std::complex<double>(after.iq[10]) / std::complex<double>(before.iq[10]));
  EXPECT_NEAR(10 * std::log10(ratio), 40 * std::log10((1000 + 30 * 10.5) / 20000), 1e-5);
}

TEST(Converter, MakesTheErrorOfItsStep) {
  RadarSettings settings = noisy();
  settings.receiver = {};
  settings.receiver.full_scale_dbm = -30;
  const double full_scale = 1e-3;  // -30 dBm are 1e-6 W
  for (const int bits : {4, 8, 12, 16}) {
    settings.receiver.adc_bits = bits;
    const double step = adc_step(settings.receiver);
    EXPECT_NEAR(step, full_scale / std::ldexp(1, bits - 1), 1e-12 * step);
    // Of many sizes below full scale, at phases that no code repeats: the error is even over a step.
    BinBlock bins(0, settings.azimuth_bins, settings.range_bins);
    for (std::size_t k = 0; k < bins.iq.size(); ++k)
      bins.iq[k] = std::complex<float>(
          std::polar(full_scale * (0.2 + 0.7 * std::fmod(static_cast<double>(k) * 0.414213562373095, 1)),
                     2 * std::numbers::pi * std::fmod(static_cast<double>(k) * 0.618033988749895, 1)));
    const BinBlock sent = bins;
    bins = received(settings, bins);
    double error = 0;
    for (std::size_t k = 0; k < bins.iq.size(); ++k)
      error += std::norm(std::complex<double>(bins.iq[k]) - std::complex<double>(sent.iq[k]));
    error /= 2 * static_cast<double>(bins.iq.size());  // of a component
    EXPECT_NEAR(error / (step * step / 12), 1, bits < 6 ? 0.03 : 0.01) << bits;
    if (bits == 12) {  // 6.02 b + 1.76: published for the 12 bits of a sine, 74.0 dB
      EXPECT_NEAR(10 * std::log10(full_scale * full_scale / 2 / error), 74.0, 0.05);
    }
    for (const std::complex<float> v : bins.iq) {
      const double counts = static_cast<double>(v.real()) / step;
      ASSERT_NEAR(counts, std::round(counts), 5e-3) << bits;
    }
  }
}

TEST(Converter, Clips) {
  RadarSettings settings = noisy();
  settings.receiver = {};
  settings.receiver.adc_bits = 8;
  settings.receiver.full_scale_dbm = 30;  // 1 sqrt(W)
  const BinBlock bins = received(settings, echoes(settings, {5, -5}));
  EXPECT_EQ(bins.iq[0].real(), 127.0F / 128);
  EXPECT_EQ(bins.iq[0].imag(), -1);
}

class ReceiverOf : public testing::TestWithParam<NamedSource> {};

TEST_P(ReceiverOf, AFrameHasTheSameBitsForAnyThreadsAndItsEchoesUnderTheNoise) {
  RadarSettings settings = small_frame(GetParam().kind);
  settings.range_normalisation = true;
  settings.power_w = 1e-3;
  settings.gain_db = 30;
  const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const Pose pose = pose_over_origin(scene->world(), 1400);
  const auto rendered = [&](int threads) {
    RenderOptions options;
    options.threads = threads;
    return render(scene, snapshot(settings), pose, {0, settings.azimuth_bins}, options).bins;
  };
  const BinBlock ideal = rendered(2);
  settings.receiver.noise = true;
  settings.receiver.gain_db = 3;
  const BinBlock bins = rendered(1);
  for (const int threads : {2, 8}) {
    const BinBlock again = rendered(threads);
    EXPECT_TRUE(same_bits(again.iq, bins.iq)) << threads;
    EXPECT_TRUE(same_bits(again.power_w, bins.power_w)) << threads;
  }
  EXPECT_TRUE(same_bits(bins.state, ideal.state));
  EXPECT_TRUE(same_bits(bins.count, ideal.count));
  // The samples' own ranges against the middle of the bin: half of 70 m in 1,500 m, to the fourth power.
  for (std::size_t k = 0; k < bins.power_w.size(); ++k) {
    ASSERT_NEAR(bins.power_w[k], ideal.power_w[k], 0.1 * ideal.power_w[k]) << k;
    ASSERT_NE(bins.iq[k], 0.0F) << k;
  }
  // Less the noise of a silent radar the echoes are left.
  settings.power_w = 0;
  const BinBlock silent = rendered(3);
  EXPECT_LT(correlation(silent.iq, ideal.iq), 0.1);
  std::vector<std::complex<float>> echo;
  for (std::size_t k = 0; k < bins.iq.size(); ++k) echo.push_back(bins.iq[k] - silent.iq[k]);
  EXPECT_GT(correlation(echo, ideal.iq), 0.99);
}

INSTANTIATE_TEST_SUITE_P(Sources, ReceiverOf, testing::ValuesIn(kEverySource),
                         source_name<testing::TestParamInfo<NamedSource>>);

TEST(Receiver, LetsNothingOutThatIsNotFinite) {
  RadarSettings settings = noisy();
  settings.receiver.gain_db = 200;
  settings.range_normalisation = true;
  BinBlock bins = echoes(settings, {3e38F, -3e38F});
  bins.iq[1] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
  bins = received(settings, bins);
  for (const std::complex<float> v : bins.iq) {
    ASSERT_TRUE(std::isfinite(v.real()));
    ASSERT_TRUE(std::isfinite(v.imag()));
  }
}

}  // namespace
}  // namespace obliq::test::receiver_test
