// The list of samplings that a frontier goes over, and the truth's own error.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/sampling_case.h"
#include "server/accuracy/truth_search.h"
#include "tests/support/scenes.h"

namespace obliq {
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
  RadarSettings settings;
  settings.frustum = FrustumKind::sweep;
  settings.sector_deg = 90;
  settings.r_min_m = 500;
  settings.r_max_m = 2500;
  settings.azimuth_bins = 8;
  settings.range_bins = 32;
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
  // A tenth of what one plane's own error is takes more planes; a millionth is not to be had with 8.
  const TruthQuality better = search_truth(*planned.plan, probe, {1, 20, 0}, 1024, shown(own), {});
  EXPECT_TRUE(better.holds);
  EXPECT_GT(better.sampling.planes_per_bin, 1);
  EXPECT_LE(better.checks[0].own, 0.1 * own);
  const TruthQuality limited = search_truth(*planned.plan, probe, {1, 20, 0}, 8, shown(1e-6 * own), {});
  EXPECT_FALSE(limited.holds);
  EXPECT_EQ(limited.sampling.planes_per_bin, 8);
}

}  // namespace
}  // namespace obliq
