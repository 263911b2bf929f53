// Expected values are worked out by hand from design section 3 on planes of a few bins.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "server/accuracy/bin_errors.h"

namespace obliq {
namespace {

/// Bins with centres at 1, 2, 3, ... m: r^3 = 1, 8, 27, 64.
RangeBins metre_bins(int n) { return {0.5, 1.0, n, false}; }

constexpr double kRounding = 1e-14;  // relative; a handful of double operations

TEST(BinErrors, QIsTruthTimesTheCubeOfTheBinCentre) {
  const RangeBins ranges = metre_bins(4);
  EXPECT_DOUBLE_EQ(ranges.centre_m(0), 1.0);
  EXPECT_DOUBLE_EQ(ranges.q(3, 2.0), 128.0);  // r at the bin's near edge would give 85.75
  RangeBins normalised = ranges;
  normalised.range_normalisation = true;
  // T = 2 W at 4 m is stored as 2 x 4^4 = 512 W; q is the same.
  EXPECT_DOUBLE_EQ(normalised.q(3, 512.0), 128.0);
}

TEST(BinErrors, PowerErrorWeighsEachLitBinByItsQSquared) {
  // q = 1, 8, 54, 64. P/T - 1 = 1, -0.5, 0, 0.25.
  const std::vector<double> truth{1, 1, 2, 1};
  const std::vector<double> power{2, 0.5, 2, 1.25};
  const BinErrors e = bin_errors(power, truth, metre_bins(4));
  EXPECT_EQ(e.lit, 4u);
  EXPECT_DOUBLE_EQ(e.median_q, (8 + 54) / 2.0);
  // sum q^2 (P/T-1)^2 = 1 + 16 + 0 + 256 = 273; sum q^2 = 1 + 64 + 2916 + 4096 = 7077. q instead of q^2 would
  // give sqrt(7/127) = 0.2348.
  EXPECT_NEAR(e.power_error, std::sqrt(273.0 / 7077.0), kRounding);
  EXPECT_NEAR(e.mean_relative, (1 + 0.5 + 0 + 0.25) / 4, kRounding);
  EXPECT_DOUBLE_EQ(e.energy_w, 5.75);
  EXPECT_NEAR(e.energy_error(), 0.15, kRounding);
}

TEST(BinErrors, DecibelsAreMedianAndNinetyFifthPercentileOfTheBinsThatHaveLight) {
  // |dB|: 0 (x1), 10 (x10), 20 (x0.01), gap, 40 (x1e4). The gap has no decibels: over 0, 10, 20, 40 the
  // median is 15 and the 95th percentile lies at 0.95 x 3 = 2.85: 20 + 0.85 x 20 = 37.
  const std::vector<double> truth{1, 1, 1, 1, 1};
  const std::vector<double> power{1, 10, 0.01, 0, 1e4};
  RangeBins one_range{0.5, 1.0, 1, false};  // five azimuths of one range: q is the same for all
  const BinErrors e = bin_errors(power, truth, one_range);
  EXPECT_EQ(e.gaps, 1u);
  EXPECT_DOUBLE_EQ(e.gap_fraction(), 0.2);
  EXPECT_NEAR(e.median_db, 15, 1e-12);
  EXPECT_NEAR(e.percentile95_db, 37, 1e-12);
  // Errors beyond 100 % count as 100 %: 0, 1 (of 9), 0.99, 1 (gap), 1 (of 9999).
  EXPECT_NEAR(e.mean_relative, 3.99 / 5, kRounding);
}

TEST(BinErrors, BinsAreLitFromOneThousandthOfTheMedianUpwards) {
  // One range: q is proportional to T. Median over T > 0 of {1e-4, 1e-3, 1, 1, 1} is 1; the dark bins do not
  // count, else it would be 1e-3 / 2 and nothing would be don't-care.
  const std::vector<double> truth{0, 0, 0, 0.9999e-3, 1e-3, 1, 1, 1};
  const std::vector<double> power{0, 0, 5, 100, 1e-3, 1, 1, 1};
  const BinErrors e = bin_errors(power, truth, {0.5, 1.0, 1, false});
  EXPECT_EQ(e.bins, 8u);
  EXPECT_DOUBLE_EQ(e.median_q, 1);
  EXPECT_EQ(e.lit, 4u);
  EXPECT_EQ(e.dark, 3u);
  EXPECT_EQ(e.dont_care, 1u);
  EXPECT_EQ(e.power_error, 0);  // the bin that is 50 dB off is one that nobody cares for
  EXPECT_EQ(e.false_light, 1u);
  EXPECT_DOUBLE_EQ(e.false_light_fraction(), 1.0 / 3);
  EXPECT_DOUBLE_EQ(e.false_light_w, 5);
  EXPECT_NEAR(e.false_light_energy(), 5 / 3.0019999, 1e-7);
}

TEST(BinErrors, RangesRepeatForEveryAzimuth) {
  // Two azimuths of two ranges. An index that runs on over azimuths would give q = 27 and 64 to the second.
  const std::vector<double> truth{1, 1, 1, 1};
  const std::vector<double> power{1, 1, 0, 1};
  const BinErrors e = bin_errors(power, truth, metre_bins(2));
  EXPECT_NEAR(e.power_error, std::sqrt(1.0 / (1 + 64 + 1 + 64)), kRounding);
}

TEST(BinErrors, RangeNormalisedPlanesGiveTheSameErrors) {
  const std::vector<double> truth{1, 1, 2, 0};
  const std::vector<double> power{2, 0.5, 0, 3};
  std::vector<double> truth_r4 = truth;
  std::vector<double> power_r4 = power;
  for (std::size_t k = 0; k < 4; ++k) {
    const double r_m = static_cast<double>(k) + 1;
    truth_r4[k] *= r_m * r_m * r_m * r_m;
    power_r4[k] *= r_m * r_m * r_m * r_m;
  }
  RangeBins normalised = metre_bins(4);
  normalised.range_normalisation = true;
  const BinErrors plain = bin_errors(power, truth, metre_bins(4));
  const BinErrors other = bin_errors(power_r4, truth_r4, normalised);
  EXPECT_NEAR(other.power_error, plain.power_error, kRounding);
  EXPECT_NEAR(other.median_db, plain.median_db, 1e-12);
  EXPECT_EQ(other.lit, plain.lit);
  EXPECT_EQ(other.gaps, 1u);
  EXPECT_EQ(other.false_light, 1u);
}

TEST(BinErrors, AFrameWithoutLightAndATruthWithoutLightAreNumbers) {
  const std::vector<double> none(4, 0.0);
  const std::vector<double> some(4, 1.0);
  const BinErrors dark = bin_errors(some, none, metre_bins(4));
  EXPECT_EQ(dark.lit, 0u);
  EXPECT_EQ(dark.compared(), 0u);
  EXPECT_EQ(dark.false_light, 4u);
  EXPECT_EQ(dark.power_error, 0);
  EXPECT_EQ(dark.energy_error(), 0);
  EXPECT_EQ(dark.false_light_energy(), 0);
  const BinErrors empty = bin_errors(none, some, metre_bins(4));
  EXPECT_DOUBLE_EQ(empty.power_error, 1);
  EXPECT_DOUBLE_EQ(empty.gap_fraction(), 1);
  EXPECT_EQ(empty.median_db, 0);
  EXPECT_EQ(empty.compared(), 0u);
  EXPECT_DOUBLE_EQ(empty.energy_error(), -1);
}

TEST(BinErrors, PlanesThatDoNotFitAreRefused) {
  const std::vector<double> four(4, 1.0);
  const std::vector<double> three(3, 1.0);
  EXPECT_THROW(bin_errors(four, three, metre_bins(1)), std::logic_error);
  EXPECT_THROW(bin_errors(four, four, metre_bins(3)), std::logic_error);
  std::vector<double> bad = four;
  bad[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(bin_errors(bad, four, metre_bins(4)), std::logic_error);
  bad[2] = -1;
  EXPECT_THROW(bin_errors(four, bad, metre_bins(4)), std::logic_error);
}

TEST(BinErrors, TheTruthSeesABuildingFromOnePercentOfAngleAndPower) {
  EXPECT_TRUE(truth_sees_building(0.01, 1.0, 0.01));
  EXPECT_FALSE(truth_sees_building(0.0099, 1.0, 1.0));
  EXPECT_FALSE(truth_sees_building(1.0, 1.0, 0.0099));
  EXPECT_FALSE(truth_sees_building(0.0, 0.0, 0.0));  // outside the sector
}

}  // namespace
}  // namespace obliq
