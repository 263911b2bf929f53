// frontier.csv, its header, the comparison with the paper's setting, the pictures.
#include "server/frontier/frontier_table.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "server/frontier/log_axis.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq::frontier_table_test {
namespace {

class Frontier : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("obliq_frontier_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

FrontierRow row(FrustumKind kind, int columns, double frame_ms, double error, double gaps,
                PlateKind plates = PlateKind::spread) {
  FrontierRow r;
  r.sampling = {kind, plates, columns, kind == FrustumKind::sweep ? 0 : columns, 30};
  r.frame_ms = frame_ms;
  r.power_error = error;
  r.median_db = error;
  r.gap_fraction = gaps;
  r.lit = 1000;
  r.gaps = 1000 * gaps;
  return r;
}

std::vector<FrontierRow> some_rows() {
  return {row(FrustumKind::symmetric, 2048, 500, 1.2, 0.3, PlateKind::nearest),
          row(FrustumKind::oblique, 2048, 400, 1.5, 0.4, PlateKind::nearest),
          row(FrustumKind::sweep, 1024, 30, 0.3, 0.2),
          row(FrustumKind::sweep, 2048, 390, 0.1, 0.05),
          row(FrustumKind::sweep, 4096, 1500, 0.01, 0.01),
          impossible_row({FrustumKind::oblique, PlateKind::spread, 4096, 4096, 30},
                         "found \"this\", and that; allowed: other")};
}

TEST_F(Frontier, RowsComeBackFromTheTableToTheSameBits) {
  FrontierRow r = row(FrustumKind::symmetric, 1024, 0.1 + 0.2, 1.0 / 3, 1e-17);
  r.returns = Returns::buildings;
  r.energy_error = -0.25;
  r.rays = 4194304;
  const auto path = folder_ / "frontier.csv";
  const std::vector<FrontierRow> all = some_rows();
  std::ofstream(path) << csv_header() << csv_line(r) << csv_line(all.back());
  const auto back = read_frontier_csv(path);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[0].sampling, r.sampling);
  EXPECT_EQ(back[0].returns, Returns::buildings);
  EXPECT_EQ(back[0].frame_ms, 0.1 + 0.2);
  EXPECT_EQ(back[0].power_error, 1.0 / 3);
  EXPECT_EQ(back[0].gap_fraction, 1e-17);
  EXPECT_EQ(back[0].energy_error, -0.25);
  EXPECT_EQ(back[0].rays, 4194304);
  EXPECT_TRUE(back[0].possible());
  EXPECT_EQ(back[1].not_possible, all.back().not_possible);  // with its quotes and its comma
}

TEST_F(Frontier, ALineThatWasCutOffIsLeftOutAndADamagedOneIsNamed) {
  const auto path = folder_ / "frontier.csv";
  const std::string line = csv_line(some_rows()[0]);
  std::ofstream(path) << csv_header() << line << line.substr(0, line.size() / 2);
  EXPECT_EQ(read_frontier_csv(path).size(), 1u);
  std::ofstream(path) << csv_header() << "sweep,many,0\n" << line;
  try {
    read_frontier_csv(path);
    FAIL() << "a damaged line was read";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("frontier.csv:2: "), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("--restart"), std::string::npos) << e.what();
  }
  std::ofstream(path) << "something,else\n";
  EXPECT_THROW(read_frontier_csv(path), InputError);
}

TEST_F(Frontier, TheComparisonTakesTheBestOfEachKindThatIsNoSlowerThanThePaper) {
  const auto table = compare_with_paper(some_rows(), 30);
  // The paper's own; symmetric, which has nothing as quick; the sweep: 4096 is better but slower than the
  // paper's.
  ASSERT_EQ(table.size(), 3u);
  EXPECT_TRUE(is_paper_sampling(table[0].sampling));
  EXPECT_EQ(table[1].sampling.kind, FrustumKind::symmetric);
  EXPECT_EQ(table[2].sampling.columns, 2048);
  EXPECT_TRUE(compare_with_paper(some_rows(), 60).empty());
}

TEST_F(Frontier, TheHeaderComesBack) {
  FrontierHeader h;
  h.key = "00ff";
  h.scene = "a \"scene\"";
  h.truth = {64, 0.5, 0};
  h.truth_checks = {{"E, all", 0.01, 0.2}};
  write_frontier_header(folder_ / "frontier.json", h);
  const auto back = read_frontier_header(folder_ / "frontier.json");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->key, h.key);
  EXPECT_EQ(back->scene, h.scene);
  EXPECT_EQ(back->truth.planes_per_bin, 64);
  EXPECT_EQ(back->truth.step_m, 0.5);
  ASSERT_EQ(back->truth_checks.size(), 1u);
  EXPECT_EQ(back->truth_checks[0].own, 0.01);
  EXPECT_FALSE(read_frontier_header(folder_ / "none.json"));
  std::ofstream(folder_ / "bad.json") << "{\"key\": 3}";
  EXPECT_THROW(read_frontier_header(folder_ / "bad.json"), InputError);
}

TEST_F(Frontier, TheReportNamesWhatWasNotPossibleAndWhatWasNotHeld) {
  FrontierHeader h;
  h.scene_cell_m = 30;
  h.truth_checks = {{"E, all", 0.1, 0.2}};
  const std::string text = frontier_markdown(h, some_rows());
  EXPECT_NE(text.find("oblique 4096 x 4096 spread, cell 30 m: found \"this\""), std::string::npos) << text;
  EXPECT_NE(text.find("| E, all | 0.1 | 0.01 | NOT held |"), std::string::npos) << text;
  EXPECT_NE(text.find("| 15 x |"), std::string::npos) << text;
}

// The header's figure is from before: what the table shows counts.
TEST_F(Frontier, TheTruthIsHeldToTheSmallestErrorOfTheTable) {
  FrontierHeader h;
  h.scene_cell_m = 30;
  h.truth_checks = {{"E, all", 0.002, 0.2}};
  EXPECT_NE(frontier_markdown(h, some_rows()).find("| E, all | 0.002 | 0.01 | NOT held |"),
            std::string::npos);
  h.truth_checks = {{"E, all", 0.0005, 0.001}};
  EXPECT_NE(frontier_markdown(h, some_rows()).find("| E, all | 0.0005 | 0.01 | held |"), std::string::npos);
}

TEST_F(Frontier, WhatIsNotThereHasNoRatioAndNoDecibels) {
  FrontierHeader h;
  h.scene_cell_m = 30;
  std::vector<FrontierRow> rows = some_rows();
  for (FrontierRow& r : rows) r.gap_fraction = r.gaps = 0;  // of the paper's setting as well
  EXPECT_EQ(frontier_markdown(h, rows).find("none left"), std::string::npos);
  rows[3].gaps = rows[3].lit;  // the best sweep's frame is empty
  EXPECT_NE(frontier_markdown(h, rows).find(" | 0.1 | - | - | "), std::string::npos)
      << frontier_markdown(h, rows);
  for (FrontierRow& r : rows) r.lit = r.gaps = 0;
  EXPECT_NE(frontier_markdown(h, rows).find("Nothing is lit here: nothing to compare."), std::string::npos);
  draw_frontier(folder_, h, rows);
}

TEST_F(Frontier, PicturesAreWrittenEvenOfNothing) {
  FrontierHeader h;
  h.scene_cell_m = 30;
  for (const auto& rows : {some_rows(), std::vector<FrontierRow>{}}) {
    draw_frontier(folder_, h, rows);
    std::stringstream svg;
    svg << std::ifstream(folder_ / "frontier.svg").rdbuf();
    EXPECT_NE(svg.str().find("</svg>"), std::string::npos);
    EXPECT_EQ(svg.str().find("nan"), std::string::npos);
    EXPECT_GT(std::filesystem::file_size(folder_ / "frontier.png"), 10000u);
  }
  EXPECT_THROW(draw_frontier(folder_ / "missing", h, {}), InputError);
}

TEST(ShortNumbers, HaveThreeDigits) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(1234.5), "1234");
  EXPECT_EQ(short_number(0.012345), "0.0123");
  EXPECT_EQ(short_number(-2.5), "-2.5");
  EXPECT_EQ(percent_text(0.446), "44.6 %");
}

TEST(LogAxes, SpanTheirValuesAndLabelDecades) {
  const LogAxis axis({0.01, 10}, 1);
  EXPECT_GT(axis.place(0.01), 0);
  EXPECT_LT(axis.place(10), 1);
  EXPECT_NEAR(axis.place(std::sqrt(0.1)), 0.5, 1e-12);
  std::string labels;
  for (const auto& tick : axis.ticks(100, " %")) labels += tick.label.empty() ? "" : tick.label + ";";
  EXPECT_EQ(labels, "1 %;10 %;100 %;1000 %;");
  labels.clear();
  for (const auto& tick : LogAxis({1e-6, 0.01}, 1).ticks(1, ""))
    labels += tick.label.empty() ? "" : tick.label + ";";
  EXPECT_EQ(labels, "1e-6;1e-5;1e-4;0.001;0.01;");
  const LogAxis flat({5}, 2);
  EXPECT_NEAR(flat.high() / flat.low(), 100, 1e-9);
}

}  // namespace
}  // namespace obliq::frontier_table_test
