// The parts of `obliq explain` that are not closed forms: comparison, verdict, changed copies, tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/explain/explanation.h"
#include "server/explain/measurement.h"
#include "server/explain/table.h"
#include "server/radar/frame_plan.h"
#include "terrain/base/text.h"
#include "terrain/buildings/building_mesh.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::parts_test {
namespace {

TEST(PowerChange, CountsWhatMovesWhatGoesAndWhatComes) {
  // Ten bins of q = 1 at r = 1.5, 2.5, ...; the last one is dark.
  const RangeBins ranges{1, 1, 10, false};
  std::vector<double> power_w, changed_w;
  for (int r = 0; r < 10; ++r) power_w.push_back(r < 9 ? std::pow(ranges.centre_m(r), -3) : 0);
  changed_w = power_w;
  EXPECT_EQ(power_change(power_w, changed_w, ranges).median_db, 0);
  changed_w[0] *= 2;    // 3 dB
  changed_w[1] = 0;     // gone
  changed_w[2] *= 0.8;  // 0.97 dB
  changed_w[9] = std::pow(ranges.centre_m(9), -3);
  const PowerChange change = power_change(power_w, changed_w, ranges);
  EXPECT_EQ(change.lit, 9u);
  EXPECT_DOUBLE_EQ(change.vanished, 1.0 / 9);
  EXPECT_DOUBLE_EQ(change.appeared, 1.0 / 9);
  EXPECT_DOUBLE_EQ(change.over_1_db, 2.0 / 9);
  // Between the largest two of eight: 0.969 + 0.65 (3.010 - 0.969).
  EXPECT_NEAR(change.percentile95_db, 2.2959, 1e-4);
  EXPECT_EQ(change.median_db, 0);
}

Explanation quiet() {
  Explanation all;
  all.facts.range_spacing_m = 30;
  return all;
}

TEST(Verdict, ASmallChangeMayBeLeftOutAndALargeOneIsNeeded) {
  Explanation all = quiet();
  Comparison c;
  c.power.median_db = 0.09;
  c.power.percentile95_db = 0.9;
  c.shift = GroundShift{14.9, 100};  // the height alone decides nothing
  decide(c, all);
  EXPECT_EQ(c.verdict, Verdict::not_needed);
  c.shift->slant_m = 15;
  decide(c, all);
  EXPECT_EQ(c.verdict, Verdict::needed);
  c.shift->slant_m = 0;
  c.power.over_1_db = 0.01;
  decide(c, all);
  EXPECT_EQ(c.verdict, Verdict::needed);
}

TEST(Verdict, AChangeThatNoiseCouldMakeUpIsSaidToBeBelowIt) {
  Explanation all = quiet();
  all.measurement_noise.median_db = 0.1;
  all.frustum_noise.median_db = 1;
  all.frustum_noise.percentile95_db = 5;
  all.frustum_noise.over_1_db = 0.5;
  Comparison c;
  c.power.median_db = 0.12;
  decide(c, all);
  EXPECT_EQ(c.verdict, Verdict::beyond_measure);
  c.power.median_db = 0.21;
  decide(c, all);
  EXPECT_EQ(c.verdict, Verdict::needed);
  EXPECT_TRUE(c.below_frustum_noise);
  c.power.median_db = 2;
  decide(c, all);
  EXPECT_FALSE(c.below_frustum_noise);
}

TEST(Verdict, NothingIsDecidedWithoutAMeasurement) {
  Comparison c;
  c.reason = "no memory";
  c.power.median_db = 9;
  decide(c, quiet());
  EXPECT_EQ(c.verdict, Verdict::not_measured);
}

TEST(Verdict, APowerThatTheCuttingMakesDecidesNothing) {
  Comparison c;
  c.ingredient = Ingredient::cell_size;
  c.power_counts = false;
  c.power.median_db = 9;
  c.shift = GroundShift{14, 100};
  decide(c, quiet());
  EXPECT_EQ(c.verdict, Verdict::not_needed);
  c.shift->slant_m = 15;
  decide(c, quiet());
  EXPECT_EQ(c.verdict, Verdict::needed);
}

TEST(Advice, ASavingWithinWhatTheSceneItselfDriftedByIsNotPrinted) {
  Explanation all = quiet();
  all.costs.frame_s = 0.100;
  all.costs.spread_s = 0.0146;  // from the first to the last measurement of the run: twice that is 30 ms
  Comparison c;
  c.ingredient = Ingredient::buildings;
  c.costs.frame_s = 0.129;
  judge(c, all);
  EXPECT_EQ(c.advice.find("ms a frame"), std::string::npos) << c.advice;
  c.costs.frame_s = 0.131;
  judge(c, all);
  EXPECT_NE(c.advice.find("costs 31 ms a frame"), std::string::npos) << c.advice;
  Comparison restless;  // one change whose own repetitions differed by more
  restless.costs.spread_s = 0.020;
  all.comparisons.push_back(restless);
  EXPECT_DOUBLE_EQ(frame_repeats_within_s(all), 0.040);
  judge(c, all);
  EXPECT_EQ(c.advice.find("ms a frame"), std::string::npos) << c.advice;
}

TEST(Advice, NothingLeftAndAllChangedAreWordsAndPlainNumbers) {
  Explanation all = quiet();
  Comparison c;
  c.ingredient = Ingredient::buildings;
  c.power.over_1_db = 1;
  judge(c, all);
  EXPECT_NE(c.advice.find(" 100 % of them"), std::string::npos) << c.advice;
  c.power.total_ratio = 0;
  judge(c, all);
  EXPECT_NE(c.advice.find("no power is left"), std::string::npos) << c.advice;
  EXPECT_EQ(c.advice.find("inf"), std::string::npos) << c.advice;
}

TEST(Report, AFrustumWithoutASampleHasNoDecibels) {
  Explanation all = quiet();
  all.facts.radius_factor = INFINITY;
  all.frustum_noise.vanished = all.frustum_noise.over_1_db = 1;
  all.frustum_noise.total_ratio = 0;
  Comparison c;
  c.name = "buildings";
  c.power.median_db = 1;
  judge(c, all);
  all.comparisons.push_back(c);
  for (const std::string& text : {plain_report(all), markdown_report(all), csv_report(all)})
    EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  EXPECT_NE(plain_report(all).find("sampling noise of this frustum: nothing sampled"), std::string::npos);
}

TEST(Rows, SayTheirClausesWithTheValuesTheyName) {
  const Values measured =
      values("loss_db"_is = -0.04, "r_km"_is = 37.0401, "none"_is = INFINITY, "rain"_is = "on");
  const std::vector<ReportRow> rows = rows_of(measured, {{"rain", true, "{rain}: {loss_db:.1f} dB"},
                                                         {"rain", false, " and {none:.1f}"},
                                                         {"rain", true, " at {r_km:4} km"},
                                                         {"gas", false, "{rain}"},
                                                         {"video", true, "{loss_db:+.1f}, {none:.2f}"}});
  ASSERT_EQ(rows.size(), 2u);  // nothing is said of gas
  EXPECT_EQ(rows[0].name, "rain");
  EXPECT_EQ(rows[0].text, "on: 0.0 dB at 37.04 km");
  EXPECT_EQ(rows[1].text, "+0.0, -");
  // A name that there is not shows in every run, whatever is said.
  EXPECT_ANY_THROW(rows_of(measured, {{"rain", false, "{snow}"}}));
}

TEST(Variants, RoofsStayWhenWallsGo) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 1000, 50);
  spec.prisms.push_back({});
  spec.prisms[0].per_km2 = 20;
  spec.prisms[0].height_m = {7, 7};
  spec.prisms[0].width_m = spec.prisms[0].length_m = {20, 20};
  const World world = load_world(spec);
  ASSERT_GT(world.buildings.list.size(), 10u);
  Buildings roofs = world.buildings;
  roofs.walls = false;
  // A rectangle has two triangles of roof and eight of wall.
  EXPECT_EQ(triangle_count(roofs) * 5, triangle_count(world.buildings));
  EXPECT_NEAR(median_sizes(world.buildings).height_m, 7, 1e-4);  // float32 at 7 m
  EXPECT_NEAR(median_sizes(world.buildings).side_m, 20, 1e-3);   // float32 corners at 1 km: 6e-5 m
  EXPECT_EQ(materials_used(world), std::vector<std::uint8_t>{1});
}

TEST(Table, AlignsWordsLeftAndNumbersRight) {
  const Table table{{{"name", "to", "dB"}}, {{"a long long long long name", "b", "1.5"}, {"c", "", "10.25"}}};
  EXPECT_EQ(plain_table(table),
            "name                  to     dB\n"
            "-------------------------------\n"
            "a long long long l..  b     1.5\n"
            "c                         10.25\n");
  EXPECT_EQ(
      markdown_table(table),
      "| name | to | dB |\n|---|---|---:|\n| a long long long long name | b | 1.5 |\n| c |  | 10.25 |\n");
}

TEST(Table, NumbersAreWrittenWithoutExponents) {
  EXPECT_EQ(short_number(3000, 1), "3000");
  EXPECT_EQ(short_number(4521.3, 3), "4521");
  EXPECT_EQ(short_number(100, 2), "100");
  EXPECT_EQ(short_number(4.0 / 3, 4), "1.333");
  EXPECT_EQ(short_number(0.1494, 3), "0.149");
  EXPECT_EQ(short_number(0.00004, 2), "0.00004");
  EXPECT_EQ(short_number(-40, 4), "-40");
  EXPECT_EQ(short_number(0, 4), "0");
  EXPECT_EQ(short_number(INFINITY, 4), "-");
}

TEST(Table, ParagraphsBreakAtSpacesBesideTheirLabel) {
  EXPECT_EQ(wrapped("x", "one two three", 10, 3), "x  one two\n   three\n");
  EXPECT_EQ(wrapped("", "one", 10, 0), "one\n");
  EXPECT_EQ(wrapped("long", "one", 10, 2), "long\n  one\n");
}

TEST(Table, CsvFieldsAreQuotedWhereTheyMust) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"x\""), "\"say \"\"x\"\"\"");
}

TEST(RasterRows, SayWhatRastersOfGammaHold) {
  World world = test::made_world(1000, 100, [](double, double) { return 0.0; });
  const auto rows_of_world = [&] {
    const auto scene = test::make_scene(World(world), test::two_materials());
    const Pose pose = test::pose_over_origin(scene->world(), 500);
    RadarSettings settings;
    settings.frustum = FrustumKind::sweep;
    return raster_rows(*plan_frame(scene, test::snapshot(settings), pose).plan);
  };
  EXPECT_TRUE(rows_of_world().empty());
  // Of 400 cells 100 with a gamma of -20 dB, 40 times 2, 10 times 4, the others as their material.
  ASSERT_EQ((world.grid.nx - 1) * (world.grid.nz - 1), 400);
  world.raster_gamma.assign(400, 1.0F);
  std::fill_n(world.raster_gamma.begin(), 100, -0.01F);
  std::fill_n(world.raster_gamma.begin() + 100, 40, 2.0F);
  std::fill_n(world.raster_gamma.begin() + 200, 10, 4.0F);
  const auto rows = rows_of_world();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(
      rows[0].text,
      "Of 400 ground cells 12.5 % return their material's power times a raster's: 3.0, 3.0, 6.0 dB, least, "
      "median, greatest. Of all 25.0 % have a raster's gamma in the material's place: -20.0, -20.0, -20.0 "
      "dB, least, median, greatest. ");
}

}  // namespace
}  // namespace obliq::parts_test
