// `obliq frontier` on tiny scenes, as an operator runs it: interrupted, resumed, read by another reader of
// CSV.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "tests/integration/apps/commands/csv.h"
#include "tests/integration/daemon.h"

namespace obliq::frontier_test {
namespace {

using test::CsvRow;
using test::TestFolder;
using test::text_of;

constexpr const char* kScene =
    "[terrain]\nsynthetic = \"hills\"\ncell_m = 40.0\n[terrain.shape]\nheight_m = 300.0\n"
    "[[prisms]]\nper_km2 = 8.0\nheight_m = [30.0, 60.0]\n[antenna]\nheight_m = 900.0\n"
    "[radar]\nsector_deg = 60.0\nr_min_m = 1500.0\nr_max_m = 4000.0\n[bins]\nazimuth = 16\nrange = 32\n";

class FrontierCommand : public testing::Test {
 protected:
  test::Outcome frontier(const std::string& scene, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"frontier", scene,        "--out", (folder_ / "files").string(),
                                       "--quick",  "--azimuths", "16",    "--pixels",
                                       "64,128",   "--repeats",  "1",     "--truth-planes-limit",
                                       "32"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_program(OBLIQ_PROGRAM, arguments, folder_.path());
  }
  std::vector<CsvRow> table() const { return test::csv_rows(text_of(folder_ / "files" / "frontier.csv")); }

  static double number(const CsvRow& row, const std::string& column) { return std::stod(row.at(column)); }
  static std::string name(const CsvRow& row) {
    return row.at("kind") + " " + row.at("columns") + " " + row.at("rows") + " " + row.at("plates") + " " +
           row.at("sub_columns");
  }

  TestFolder folder_;
};

TEST_F(FrontierCommand, GoesOnWhereItStoppedAndItsTableAddsUp) {
  const std::string scene = folder_.write("scene.toml", kScene);
  const auto first = frontier(scene, {"--stop-after", "2"});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.err.find("truth: "), std::string::npos) << first.err;
  const std::string begun = text_of(folder_ / "files" / "frontier.csv");
  ASSERT_EQ(test::csv_rows(begun).size(), 6u);  // two samplings of all, terrain and buildings

  // As if the next line had been cut off while it was written.
  {
    std::ofstream file(folder_ / "files" / "frontier.csv", std::ios::app);
    file << "oblique,64,64,nea";
  }
  const auto second = frontier(scene, {});
  ASSERT_EQ(second.code, 0) << second.err;
  EXPECT_NE(second.err.find("resuming after 6 lines"), std::string::npos) << second.err;
  EXPECT_EQ(text_of(folder_ / "files" / "frontier.csv").substr(0, begun.size()), begun);

  const std::vector<CsvRow> rows = table();
  std::map<std::string, int> lines;
  std::set<std::string> kinds;
  const CsvRow* paper = nullptr;
  for (const CsvRow& row : rows) {
    ++lines[name(row)];
    kinds.insert(row.at("kind"));
    EXPECT_EQ(row.at("not_possible"), "") << name(row);
    EXPECT_GT(number(row, "frame_ms"), 0);
    EXPECT_GE(number(row, "frame_median_ms"), number(row, "frame_ms"));
    EXPECT_GT(number(row, "processor_ms"), 0);
    // Every bin is lit, dark or neither; fractions are the counts' ratios.
    EXPECT_EQ(number(row, "bins"), 16 * 32);
    EXPECT_EQ(number(row, "lit") + number(row, "dark") + number(row, "dont_care"), number(row, "bins"));
    EXPECT_DOUBLE_EQ(number(row, "gap_fraction"), number(row, "gaps") / number(row, "lit"));
    if (number(row, "dark") > 0) {
      EXPECT_DOUBLE_EQ(number(row, "false_light_fraction"), number(row, "false_light") / number(row, "dark"));
    }
    EXPECT_LE(number(row, "median_db"), number(row, "percentile95_db"));
    EXPECT_LE(number(row, "buildings_missed"), number(row, "buildings_visible"));
    if (row.at("returns") == "all" && name(row) == "oblique 2048 2048 nearest 0") paper = &row;
  }
  for (const auto& [sampling, n] : lines) EXPECT_EQ(n, 3) << sampling;
  EXPECT_EQ(kinds, (std::set<std::string>{"oblique", "sweep", "symmetric"}));
  ASSERT_NE(paper, nullptr);

  // The comparison in the report is that of the table: recomputed here from the CSV.
  const CsvRow* sweep = nullptr;
  for (const CsvRow& row : rows)
    if (row.at("returns") == "all" && row.at("kind") == "sweep" &&
        number(row, "frame_ms") <= number(*paper, "frame_ms") &&
        (sweep == nullptr || number(row, "power_error") < number(*sweep, "power_error")))
      sweep = &row;
  ASSERT_NE(sweep, nullptr);
  const double ratio = number(*paper, "power_error") / number(*sweep, "power_error");
  const std::string report = text_of(folder_ / "files" / "frontier.md");
  const std::size_t line = report.find("| sweep " + sweep->at("columns") + ", ");
  ASSERT_NE(line, std::string::npos) << report;
  std::stringstream cells(report.substr(line, report.find('\n', line) - line));
  std::string cell;
  for (int k = 0; k < 6; ++k) std::getline(cells, cell, '|');  // empty, sampling, ms, quicker, E, E lower
  EXPECT_NEAR(std::stod(cell), ratio, 0.006 * ratio) << cell;  // three digits are shown

  for (const char* picture : {"frontier.svg", "frontier.png"})
    EXPECT_GT(std::filesystem::file_size(folder_ / "files" / picture), 10000u);

  // A third run finds nothing to do and says the same.
  const auto third = frontier(scene, {});
  EXPECT_EQ(third.code, 0) << third.err;
  EXPECT_EQ(text_of(folder_ / "files" / "frontier.md"), report);
}

TEST_F(FrontierCommand, AnotherRunsTableIsRefusedUnlessThrownAway) {
  const std::string scene = folder_.write("scene.toml", kScene);
  ASSERT_EQ(frontier(scene, {"--stop-after", "1"}).code, 0);
  const auto other = frontier(scene, {"--stop-after", "1", "--set", "radar.r_max_m=3900"});
  EXPECT_NE(other.code, 0);
  EXPECT_NE(other.err.find("found the table of another run"), std::string::npos) << other.err;
  EXPECT_EQ(table().size(), 3u);
  // What the samplings set themselves, and the server's, makes no other table.
  const auto same =
      frontier(scene, {"--stop-after", "1", "--set", "frustum.pixels=300", "--set", "server.port=7000"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_EQ(table().size(), 6u);
  const auto again = frontier(scene, {"--stop-after", "1", "--set", "radar.r_max_m=3900", "--restart"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(table().size(), 3u);
}

TEST_F(FrontierCommand, WhatCannotSeeTheSceneIsListedWithItsReason) {
  // An antenna below the hills, and a sector that no symmetric camera sees.
  const std::string scene = folder_.write("scene.toml", kScene);
  const auto run = frontier(scene, {"--set", "radar.sector_deg=200", "--set", "antenna.height_m=20", "--set",
                                    "antenna.height_reference=ground"});
  ASSERT_EQ(run.code, 0) << run.err;
  int impossible = 0;
  bool swept = false;
  for (const CsvRow& row : table()) {
    const bool camera = row.at("kind") == "symmetric" || row.at("kind") == "oblique";
    EXPECT_EQ(row.at("not_possible").empty(), !camera) << name(row) << ": " << row.at("not_possible");
    impossible += camera ? 1 : 0;
    swept = swept || row.at("kind") == "sweep";
  }
  EXPECT_GT(impossible, 4);
  EXPECT_TRUE(swept);
  EXPECT_NE(text_of(folder_ / "files" / "frontier.md").find("## Not possible here"), std::string::npos);
}

TEST_F(FrontierCommand, AgainstTheReferenceItMeasuresTheDistanceFromEightPlanes) {
  const std::string scene = folder_.write("scene.toml", kScene);
  const auto errors_against = [&](const std::string& what) {
    const auto run =
        test::run_program(OBLIQ_PROGRAM,
                          {"frontier", scene, "--out", (folder_ / what).string(), "--against", what,
                           "--kinds", "sweep", "--repeats", "1", "--cells", "80", "--sub-columns", "0,16"},
                          folder_.path());
    EXPECT_EQ(run.code, 0) << run.err;
    std::map<std::string, CsvRow> rows;
    for (const CsvRow& row : test::csv_rows(text_of(folder_ / what / "frontier.csv")))
      rows[row.at("columns") + " " + row.at("sub_columns") + " " + row.at("cell_m") + " " +
           row.at("returns")] = row;
    return rows;
  };
  const auto truth = errors_against("truth"), reference = errors_against("reference");
  // 1, 2, 4 and 8 planes, exact and with sub-columns, and 1, 2 and 4 over other cells; 8 exact ones are the
  // reference itself.
  ASSERT_EQ(truth.size(), 11u * 3);
  ASSERT_EQ(reference.size(), 10u * 3);
  for (const auto& [key, row] : reference) {
    const CsvRow& same = truth.at(key);
    const CsvRow& eight = truth.at("128 0 40 " + row.at("returns"));
    // Bin by bin the frame is as far from the reference as from the truth, but for the reference's own error.
    EXPECT_NEAR(number(row, "power_error"), number(same, "power_error"), 1.2 * number(eight, "power_error"))
        << key;
    // Sums of the same powers in another order.
    EXPECT_NEAR(1 + number(row, "energy_error"),
                (1 + number(same, "energy_error")) / (1 + number(eight, "energy_error")), 1e-9)
        << key;
    EXPECT_GE(number(row, "buildings_visible"), number(same, "buildings_visible")) << key;
  }
  const std::string report = text_of(folder_ / "reference" / "frontier.md");
  EXPECT_NE(report.find("the sweep with 8 planes in each azimuth bin and exact strands"), std::string::npos)
      << report;
}

TEST_F(FrontierCommand, MaterialsWithoutATruthAreRefused) {
  const std::string scene = folder_.write("scene.toml", kScene);
  const auto run = frontier(scene, {"--set", "materials.building.model=flat_plate"});
  EXPECT_NE(run.code, 0);
  EXPECT_NE(run.err.find("flat"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace obliq::frontier_test
