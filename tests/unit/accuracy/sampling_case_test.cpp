// The list of samplings that a frontier goes over, and the truth's own error.
// Expected values are worked out by hand from PAPER.md, definitions, on planes of a few bins.
#include "server/accuracy/sampling_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/truth_search.h"
#include "terrain/base/errors.h"
#include "tests/support/scenes.h"

namespace obliq::sampling_case_test {
namespace {

RadarSettings few_bins() {
  RadarSettings s;
  s.azimuth_bins = 100;
  s.range_bins = 50;
  return s;
}

TEST(SamplingCases, ThePapersSettingIsAlwaysThereAndEachOnce) {
  FrontierRange range;
  range.pixels = {64};
  range.cells_m = {30, 60};
  const auto cases = frontier_cases(few_bins(), range);
  EXPECT_EQ(std::ranges::count_if(cases, is_paper_sampling), 1);
  for (const SamplingCase& c : cases) EXPECT_EQ(std::ranges::count(cases, c), 1) << sampling_text(c);
  // Cells come one after the other: ground is loaded once for each.
  EXPECT_TRUE(std::ranges::is_sorted(cases, {}, &SamplingCase::cell_m));
}

TEST(SamplingCases, TheSweepsFollowTheBins) {
  FrontierRange range;
  range.cells_m = {30};
  const auto cases = frontier_cases(few_bins(), range);
  const auto has = [&](FrustumKind kind, int columns, int rows) {
    return std::ranges::any_of(cases, [&](const SamplingCase& c) {
      return c.kind == kind && c.columns == columns && c.rows == rows;
    });
  };
  EXPECT_TRUE(has(FrustumKind::sweep, 800, 0));
  EXPECT_TRUE(has(FrustumKind::sweep, 200, 0));
  RadarSettings many = few_bins();
  many.azimuth_bins = 8192;
  for (const SamplingCase& c : frontier_cases(many, range)) EXPECT_LE(c.columns, 16384) << sampling_text(c);
}

TEST(SamplingCases, ASamplingBecomesSettings) {
  const RadarSettings s = with_sampling(few_bins(), paper_sampling(30));
  EXPECT_EQ(s.frustum, FrustumKind::oblique);
  EXPECT_EQ(s.plates, PlateKind::nearest);
  EXPECT_EQ(s.pixel_columns, 2048);
  EXPECT_EQ(s.pixel_rows, 2048);
  EXPECT_EQ(s.azimuth_bins, 100);
}

TEST(SamplingCases, TheSweepsAreOfRadarsWithAnySpeckle) {
  RadarSettings s = few_bins();
  s.speckle = SpeckleKind::geometric;
  EXPECT_EQ(with_sampling(s, paper_sampling(30)).speckle, SpeckleKind::geometric);
  SamplingCase sweep = paper_sampling(30);
  sweep.kind = FrustumKind::sweep;
  EXPECT_TRUE(sampling_faults(with_sampling(s, sweep)).empty());
}

TEST(ChosenAzimuths, AreWholeWedgesSpreadOverTheSector) {
  const AzimuthRuns runs = choose_azimuths(1024, 60);
  EXPECT_EQ(azimuth_count(runs), 64);  // 8 wedges of 8
  // Eight wedges of 128 stand at the middles of eighths: wedge 8, 24, ...
  ASSERT_EQ(runs.size(), 8u);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    EXPECT_EQ(runs[k].first, (8 + 16 * static_cast<int>(k)) * kWedgeAzimuthBins);
    EXPECT_EQ(runs[k].count, kWedgeAzimuthBins);
  }
  EXPECT_EQ(azimuth_count(choose_azimuths(1024, 0)), 1024);
  EXPECT_EQ(azimuth_count(choose_azimuths(5, 64)), 5);
  // 20 bins are wedges of 8, 8 and 4: the last one is short.
  EXPECT_EQ(azimuth_count(choose_azimuths(20, 19)), 20);
}

TEST(TruthCheck, HoldsUpToATenthOfWhatIsShown) {
  EXPECT_TRUE((TruthCheck{"E", 0.1, 1.0}.holds()));
  EXPECT_FALSE((TruthCheck{"E", 0.11, 1.0}.holds()));
  EXPECT_TRUE((TruthCheck{"E", 0.5, 0.0}.holds()));  // nothing is shown that it could spoil
}

TEST(SmallestErrors, AreTheSmallestThatAreNotZero) {
  SmallestErrors smallest;
  FrameMeasurement frame;
  frame.errors[0].bins.power_error = 0.5;
  frame.errors[0].bins.median_db = 0.2;
  smallest.add(frame);
  frame.errors[0].bins.power_error = 0.3;
  frame.errors[0].bins.median_db = 0;
  smallest.add(frame);
  BinErrors own[3];
  own[0].power_error = 0.031;
  const auto checks = smallest.check(own, false);
  ASSERT_EQ(checks.size(), 4u);  // without buildings there is one part of the returns
  EXPECT_EQ(checks[0].smallest, 0.3);
  EXPECT_FALSE(checks[0].holds());
  EXPECT_EQ(checks[1].smallest, 0.2);
}

TEST(MissedBuildings, AreThoseThatTheTruthSeesAndNoSampleCarries) {
  std::vector<BuildingTruth> truth(4);
  truth[0] = {1e-6, 1e-6, 0.5};   // seen
  truth[1] = {1e-6, 1e-6, 0.5};   // missed
  truth[2] = {1e-9, 1e-6, 0.5};   // hidden but for a thousandth
  truth[3] = {1e-6, 1e-6, 1e-3};  // drowned by the ground in its bins
  const BuildingErrors e = missed_buildings(truth, [](std::uint32_t i) { return i == 0; });
  EXPECT_EQ(e.visible, 2u);
  EXPECT_EQ(e.missed, 1u);
}

TEST(MatchedBuildings, AreFoundByTheirOutlineWhateverTheCellSize) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 1500, 20);
  spec.prisms = {PrismSpec{}};
  spec.prisms[0].per_km2 = 20;
  const World fine = load_world(spec);
  spec.terrain.cell_m = 50;
  World coarse = load_world(spec);
  ASSERT_GT(fine.buildings.list.size(), 20u);
  // Drop one building in the coarse world: the others still find themselves, by another index.
  coarse.buildings.list.erase(coarse.buildings.list.begin() + 3);
  const auto match = match_buildings(fine.buildings, coarse.buildings);
  ASSERT_EQ(match.size(), fine.buildings.list.size());
  EXPECT_EQ(match[2], 2u);
  EXPECT_EQ(match[3], kNoBuilding);
  EXPECT_EQ(match[4], 3u);
}

TEST(TruthSearch, RaisesThePlanesUntilATenthOfTheErrorIsHeld) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 3000, 50);
  spec.terrain.shape.height_m = 300;
  const auto scene = test::make_scene(load_world(spec));
  RadarSettings settings = test::radar_settings(FrustumKind::sweep, {500, 2500, 90}, {8, 32});
  const PlanResult planned =
      plan_frame(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), 600));
  ASSERT_TRUE(planned.plan) << all_text(planned.errors);
  const auto shown = [](double error) {
    return [error](const TruthBins&) {
      SmallestErrors smallest;
      FrameMeasurement frame;
      frame.errors[0].bins.power_error = error;
      smallest.add(frame);
      return smallest;
    };
  };
  const AzimuthRuns probe{{0, 8}};
  const TruthQuality rough = search_truth(*planned.plan, probe, {1, 20, 0}, 64, shown(10), {});
  EXPECT_TRUE(rough.holds);
  EXPECT_EQ(rough.sampling.planes_per_bin, 1);
  const double own = rough.checks[0].own;
  ASSERT_GT(own, 0);
  // A tenth of what one plane's own error is takes more planes; 8 planes do not reach a millionth.
  const TruthQuality better = search_truth(*planned.plan, probe, {1, 20, 0}, 1024, shown(own), {});
  EXPECT_TRUE(better.holds);
  EXPECT_GT(better.sampling.planes_per_bin, 1);
  EXPECT_LE(better.checks[0].own, 0.1 * own);
  const TruthQuality limited = search_truth(*planned.plan, probe, {1, 20, 0}, 8, shown(1e-6 * own), {});
  EXPECT_FALSE(limited.holds);
  EXPECT_EQ(limited.sampling.planes_per_bin, 8);
}

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

RadarSettings settings(FrustumKind kind) {
  RadarSettings s;
  s.frustum = kind;
  s.azimuth_bins = 1000;
  s.range_bins = 500;
  return s;
}

BinErrors errors(double median_db, std::uint64_t gaps) {
  BinErrors e;
  e.lit = 100;
  e.gaps = gaps;
  e.median_db = median_db;
  return e;
}

TEST(SamplingLadder, RisesToTheLimitOfPixelsAndKeepsTheUsersKind) {
  for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    const auto ladder = sampling_ladder(settings(kind), 30);
    ASSERT_GT(ladder.size(), 3u);
    for (std::size_t k = 0; k < ladder.size(); ++k) {
      EXPECT_EQ(ladder[k].kind, kind);
      EXPECT_EQ(ladder[k].cell_m, 30);
      EXPECT_LE(ladder[k].columns, 16384);
      if (k > 0) {
        EXPECT_EQ(ladder[k].columns, 2 * ladder[k - 1].columns);
      }
    }
  }
  EXPECT_EQ(sampling_ladder(settings(FrustumKind::oblique), 30).back().columns, 16384);
  EXPECT_EQ(sampling_ladder(settings(FrustumKind::sweep), 30).back().columns, 16000);
}

TEST(SamplingLadder, ClimbsToTheFirstThatIsGoodEnoughInBothMeasures) {
  const auto ladder = sampling_ladder(settings(FrustumKind::sweep), 30);
  const AccuracyLimit limit{0.1, 0.02};
  // dB is good from the second on, gaps from the third.
  const auto tried = climb(ladder, limit, [&](const SamplingCase& s) {
    return errors(s.columns > 1000 ? 0.05 : 0.5, s.columns > 2000 ? 2 : 3);
  });
  ASSERT_EQ(tried.size(), 3u);
  EXPECT_EQ(tried.back().sampling.columns, 4000);
}

TEST(SamplingLadder, EndsWithoutOneThatIsGoodEnough) {
  const auto ladder = sampling_ladder(settings(FrustumKind::symmetric), 30);
  const AccuracyLimit limit{0.1, 1};
  const auto tried = climb(ladder, limit, [](const SamplingCase&) { return errors(0.2, 0); });
  EXPECT_EQ(tried.size(), ladder.size());
  EXPECT_FALSE(limit.met_by(tried.back().errors));
  EXPECT_THROW(climb(ladder, limit, [](const SamplingCase&) -> BinErrors { throw InputError("no"); }),
               InputError);
}

// An empty frame has no decibels, and 0 of them would be within any limit.
TEST(SamplingLadder, NothingComparedMeetsNoLimit) {
  const AccuracyLimit any{100, 1};
  EXPECT_FALSE(any.met_by(errors(0, 100)));
  EXPECT_TRUE(any.met_by(errors(0, 99)));
  EXPECT_FALSE(any.met_by(BinErrors{}));
}

}  // namespace
}  // namespace obliq::sampling_case_test
