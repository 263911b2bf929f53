// The fast time constant of the video: what is even in range goes, edges stay.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/radar/receiver/video_fixture.h"

namespace obliq::test::ftc_test {
namespace {

/// 2 us are 300 m, ten bins of 30 m.
TEST(Video, WithAFastTimeConstantIsWhatABinHasAboveItsMean) {
  RadarSettings settings = radar();
  settings.video.ftc_us = 2;
  BinBlock bins(0, settings.azimuth_bins, settings.range_bins);
  const auto set = [&](int bin, double power_w) {
    bins.iq[static_cast<std::size_t>(bin)] = static_cast<float>(std::sqrt(power_w));
  };
  for (int r = 0; r < 512; ++r) set(r, r < 200 ? 1e-12 : 4e-12);  // a step
  set(100, 9e-12);                                                // a point in the even part
  const BinBlock out = video_of(settings, bins);
  const auto expected = [](double power_w) { return level_of(power_w, -150, 100, 65536); };
  EXPECT_EQ(out.video16[100], expected(9e-12 - (9 * 1e-12 + 9e-12) / 10));
  EXPECT_LE(out.video16[99], 1) << "what is even goes";
  EXPECT_EQ(out.video16[105], 0) << "behind a point the mean is above the bin";
  EXPECT_LE(out.video16[115], 1) << "as long as the time constant";
  for (int k = 0; k < 9; ++k)
    EXPECT_NEAR(out.video16[static_cast<std::size_t>(200 + k)], expected(3e-12 * (9 - k) / 10), 1) << k;
  EXPECT_LE(out.video16[210], 1);
  EXPECT_EQ(video_of(settings, bins, {true, false, false}).iq, bins.iq) << "I&Q do not pass it";
  settings.video.ftc_us = 0.001;  // less than a bin: of two
  EXPECT_EQ(video_of(settings, bins).video16[100], expected(4e-12));
  settings.video.ftc_us = 0;
  EXPECT_EQ(video_of(settings, bins).video16[100], expected(9e-12));
}

TEST(Video, WithAFastTimeConstantLosesRainAndKeepsABuilding) {
  RadarSettings settings = radar();
  settings.video.looks = 256;
  BinBlock bins = even(settings, 0);
  for (std::size_t k = 0; k < bins.power_w.size(); ++k) {
    const double r = static_cast<double>(k % 512);
    bins.power_w[k] = 1e-10 * std::pow(1 + r / 100, -2) * (k % 512 == 300 ? 40 : 1);  // rain falls slowly
  }
  const auto mean_level = [&](const BinBlock& out, int from, int to) {
    double sum = 0;
    for (int a = 0; a < settings.azimuth_bins; ++a)
      for (int r = from; r < to; ++r) sum += out.video8[static_cast<std::size_t>(a * 512 + r)];
    return sum / settings.azimuth_bins / (to - from);
  };
  const BinBlock rain = video_of(settings, bins);
  settings.video.ftc_us = 4;
  const BinBlock clear = video_of(settings, bins);
  EXPECT_GT(mean_level(rain, 250, 290), 80);
  EXPECT_LT(mean_level(clear, 250, 290), 0.5 * mean_level(rain, 250, 290));
  EXPECT_GT(mean_level(clear, 300, 301), mean_level(rain, 300, 301) - 2) << "within a decibel";
}

}  // namespace
}  // namespace obliq::test::ftc_test
