// `obliq explain` on small synthetic scenes, as an operator runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "tests/integration/daemon.h"

namespace obliq::explain_test {
namespace {

using test::Outcome;
using test::TestFolder;
using test::text_of;

using Row = std::map<std::string, std::string>;

/// Fields of one CSV text by RFC 4180.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c != '"') {
        field += c;
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        field += '"';
        ++i;
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',' || c == '\n') {
      row.push_back(field);
      field.clear();
      if (c == '\n') {
        rows.push_back(row);
        row.clear();
      }
    } else {
      field += c;
    }
  }
  return rows;
}

std::vector<Row> rows_of(const std::string& csv) {
  const auto lines = parse_csv(csv);
  std::vector<Row> rows;
  for (std::size_t n = 1; n < lines.size(); ++n) {
    EXPECT_EQ(lines[n].size(), lines[0].size()) << "line " << n;
    Row row;
    for (std::size_t k = 0; k < lines[n].size() && k < lines[0].size(); ++k) row[lines[0][k]] = lines[n][k];
    rows.push_back(row);
  }
  return rows;
}

Row row_named(const std::vector<Row>& rows, const std::string& name) {
  for (const Row& row : rows)
    if (row.at("ingredient") == name) return row;
  ADD_FAILURE() << "no line " << name;
  return {};
}

double number(const Row& row, const std::string& column) { return std::stod(row.at(column)); }

constexpr auto kTown =
    "[terrain]\nsynthetic = \"hills\"\ncell_m = 40.0\nshape = {height_m = 300.0}\n"
    "[[prisms]]\nper_km2 = 60.0\n[materials.terrain]\ngamma_db = -15.0\n"
    "[antenna]\nheight_m = 1500\n[radar]\nsector_deg = 60\nr_min_m = 2000\nr_max_m = 5000\n"
    "range_normalisation = true\n"
    "[frustum]\nkind = \"oblique\"\npixels = 256\n[bins]\nazimuth = 40\nrange = 64\n";

class Explain : public testing::Test {
 protected:
  Outcome explain(const std::string& scene, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"explain", folder_.write("scene.toml", scene), "--out",
                                       folder_ / "out_files"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_program(OBLIQ_PROGRAM, arguments, folder_.path());
  }
  std::vector<Row> rows() const { return rows_of(text_of(folder_ / "out_files" / "explain.csv")); }

  TestFolder folder_;
};

/// The town, explained once by one thread for several tests.
class ExplainedTown : public Explain {
 protected:
  void SetUp() override {
    if (!town_.empty()) return;
    outcome_ = explain(kTown, {"--threads", "1"});
    ASSERT_EQ(outcome_.code, 0) << outcome_.err;
    town_ = rows();
    markdown_ = text_of(folder_ / "out_files" / "explain.md");
  }

  inline static Outcome outcome_;
  inline static std::vector<Row> town_;
  inline static std::string markdown_;
};

/// Level ground from 1 km, in few bins.
std::string flat_scene(const std::string& earth, double r_min_m, double r_max_m, double cell_m) {
  std::ostringstream text;
  text << "[terrain]\nsynthetic = \"flat\"\ncell_m = " << cell_m << ".0\n"
       << earth << "[antenna]\nheight_m = 1000\n"
       << "[radar]\nsector_deg = 30\nr_min_m = " << r_min_m << "\nr_max_m = " << r_max_m
       << "\n[frustum]\nkind = \"oblique\"\npixels = [256, 512]\n[bins]\nazimuth = 32\nrange = 128\n";
  return text.str();
}

constexpr auto kStandardEarth = "[earth]\nradius_factor = 1.333333333333333\n";

TEST_F(Explain, CurvatureIsNeededOnALongFlatScene) {
  const Outcome outcome = explain(flat_scene(kStandardEarth, 3700, 60000, 400));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Row row = row_named(rows(), "earth curvature");
  EXPECT_TRUE(row.at("verdict").starts_with("needed")) << row.at("verdict");
  // At r_max: r^2 / 2kR = 211.9 m of height, and r h / 2kR + drop^2 / 2r = 3.53 + 0.37 m of slant range. The
  // last probe stands within 0.2 % of r_max, 400 m cells bend 2 mm.
  EXPECT_NEAR(number(row, "height_shift_m"), 211.9, 0.01 * 211.9);
  EXPECT_NEAR(number(row, "slant_shift_m"), 3.90, 0.03 * 3.90);
  // 1 - r^2 / 2kRh: the far tenth of the bins, from 54.4 to 60 km, changes by 0.83 to 1.03 dB.
  EXPECT_GT(number(row, "percentile95_db"), 0.83);
  EXPECT_LT(number(row, "percentile95_db"), 1.1);
  // The median bin, at 31.9 km, by 0.268 dB.
  EXPECT_NEAR(number(row, "median_db"), 0.268, 0.03);
}

TEST_F(Explain, CurvatureMayBeLeftOutOnAShortFlatScene) {
  const Outcome outcome =
      explain(flat_scene(kStandardEarth, 1100, 2000, 20), {"--set", "radar.sector_deg=360.0"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Row row = row_named(rows(), "earth curvature");
  EXPECT_EQ(row.at("verdict"), "may be left out");
  // 2 km: 0.24 m of height; 1 - r^2 / 2kRh is 0.001 dB. What the noise adds is below a hundredth.
  EXPECT_NEAR(number(row, "height_shift_m"), 0.177, 0.01);  // at g = sqrt(r_max^2 - h^2) = 1732 m
  EXPECT_LT(number(row, "median_db"), 0.01);
  EXPECT_NE(outcome.out.find("may be left out"), std::string::npos);
}

TEST_F(Explain, TheDropAtTheFarEdgeIsPrintedWithItsFormula) {
  const Outcome outcome = explain(flat_scene("[earth]\nradius_factor = 1.0\n", 3700, 37000, 400));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<Row> all = rows();
  const std::string text = row_named(all, "earth curvature").at("threshold");
  EXPECT_NE(text.find("r^2/(2kR)"), std::string::npos) << text;
  EXPECT_NE(text.find("107.4 m at 37 km"), std::string::npos) << text;
  EXPECT_NEAR(number(row_named(all, "earth curvature"), "height_shift_m"), 107.4, 1.1);
  // A scene with k = 1 has no refraction: what it would add is 1 - 3/4 of the drop.
  const Row refraction = row_named(all, "refraction");
  EXPECT_NEAR(number(refraction, "height_shift_m"), 26.9, 0.3);
  EXPECT_EQ(refraction.at("changed_to"), "with k = 1.333");
}

TEST_F(Explain, AFlatSceneIsToldWhatCurvatureWouldAdd) {
  const Outcome outcome = explain(flat_scene("", 3700, 60000, 400));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<Row> all = rows();
  EXPECT_EQ(row_named(all, "earth curvature").at("changed_to"), "with k = 1.333");
  EXPECT_NE(row_named(all, "earth curvature").at("advice").find("this scene leaves it out"),
            std::string::npos);
  EXPECT_EQ(row_named(all, "refraction").at("changed_to"), "k = 1, not 4/3");
  EXPECT_NEAR(number(row_named(all, "refraction"), "height_shift_m"), 282.5 - 211.9, 0.8);
}

TEST_F(ExplainedTown, BuildingsWallsAndMaterialsAreTakenOutOneByOne) {
  const Row scene = row_named(town_, "scene");
  const Row walls = row_named(town_, "building walls");
  const Row none = row_named(town_, "buildings");
  const Row material = row_named(town_, "material building");
  // Buildings here are 15 dB brighter than their ground: all three lose power, and no walls at all less than
  // no buildings at all; the same walls in the ground's material leave the ground as it was.
  EXPECT_LT(number(walls, "total_db"), -0.05);
  EXPECT_LT(number(none, "total_db"), -0.05);
  EXPECT_LT(number(material, "total_db"), -0.05);
  EXPECT_TRUE(none.at("verdict").starts_with("needed"));
  EXPECT_LT(number(walls, "embree_mb"), number(scene, "embree_mb"));
  EXPECT_LT(number(none, "buildings_mb"), 1e-4);
  EXPECT_EQ(number(material, "buildings_mb"), number(scene, "buildings_mb"));
  EXPECT_EQ(number(row_named(town_, "speckle"), "median_db"), 0);  // powers do not depend on speckle
  EXPECT_LT(number(scene, "source_error_p95_m"),
            number(row_named(town_, "cell size x 2"), "source_error_p95_m"));
  EXPECT_GT(number(row_named(town_, "sampling noise of this frustum"), "median_db"),
            number(row_named(town_, "sampling noise of this measurement"), "median_db"));
}

TEST_F(ExplainedTown, TextFitsAHundredColumnsAndMarkdownHasTheSameVerdicts) {
  EXPECT_TRUE(outcome_.err.starts_with("terrain: ")) << outcome_.err;
  std::istringstream lines(outcome_.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
  for (const Row& row : town_) {
    if (row.at("advice").empty()) continue;
    EXPECT_NE(markdown_.find(row.at("advice")), std::string::npos) << row.at("ingredient");
  }
}

TEST_F(ExplainedTown, HasTheSamePowersOnAnyNumberOfThreads) {
  const auto measures = [](const std::vector<Row>& of) {
    std::vector<std::string> found;
    for (const Row& row : of)
      for (const char* column :
           {"median_db", "percentile95_db", "over_1_db", "vanished", "appeared", "total_db"})
        found.push_back(row.at(column));
    return found;
  };
  ASSERT_EQ(explain(kTown, {"--threads", "3"}).code, 0);
  EXPECT_EQ(measures(rows()), measures(town_));
}

TEST_F(Explain, AFrustumThatSamplesNothingIsSaidInWords) {
  // One pixel in one of 512 azimuth bins, the middle one: of the 64 wedges the measured ones are 4, 12,
  // ..., 60.
  const Outcome outcome =
      explain(flat_scene("", 1100, 2000, 20),
              {"--set", "bins.azimuth=512", "--set", "frustum.plates=nearest", "--set", "frustum.pixels=1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("sampling noise of this frustum: nothing sampled"), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("nothing sampled by this frustum: no contrast"), std::string::npos);
  for (const char* word : {"inf", "nan", "e+0"})
    EXPECT_EQ(outcome.out.find(word), std::string::npos) << word << "\n" << outcome.out;
}

TEST_F(Explain, AFlatPlateIsNamedAndTheCellSizeHasNoVerdictInPower) {
  const Outcome outcome = explain(kTown, {"--set", "materials.building.model=\"flat_plate\""});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("Flat plates (building)"), std::string::npos) << outcome.out;
  const std::vector<Row> all = rows();
  for (const char* name : {"cell size x 2", "cell size x 1/2"}) {
    const Row row = row_named(all, name);
    EXPECT_EQ(row.at("median_db"), "") << name;
    EXPECT_NE(row.at("advice").find("no verdict in power"), std::string::npos) << row.at("advice");
    EXPECT_GT(number(row, "slant_shift_m"), 0) << name;
  }
  EXPECT_NE(row_named(all, "material building").at("threshold").find("flat plate"), std::string::npos);
  EXPECT_NE(row_named(all, "buildings").at("median_db"), "");
}

TEST_F(Explain, WhatNeedsRaysIsComparedWithObliqueOnesForASweepOrSaidNotToBe) {
  Outcome outcome = explain(kTown, {"--set", "frustum.quality=draft"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(row_named(rows(), "speckle").at("changed_to"), "geometric, with oblique rays");
  EXPECT_EQ(number(row_named(rows(), "speckle"), "median_db"), 0);
  EXPECT_LT(number(row_named(rows(), "building walls"), "total_db"), -0.05);
  EXPECT_NE(outcome.out.find("sampling noise where walls are compared"), std::string::npos);
  // The sweep sees straight down, a camera does not.
  outcome = explain(kTown, {"--set", "frustum.quality=draft", "--set", "radar.r_min_m=500"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name : {"speckle", "building walls"}) {
    EXPECT_EQ(row_named(rows(), name).at("verdict"), "not measured") << name;
    EXPECT_NE(row_named(rows(), name).at("advice").find("radar.r_min_m: found 500"), std::string::npos)
        << row_named(rows(), name).at("advice");
  }
  EXPECT_LT(number(row_named(rows(), "buildings"), "total_db"), -0.05);
  EXPECT_EQ(outcome.out.find("sampling noise where walls are compared"), std::string::npos);
}

TEST_F(Explain, TheThresholdOfABuildingsMaterialCountsItsWalls) {
  // Roofs return what the ground does, walls the lobe of a mirror as well: R / (2 s^2) sec^5 exp(-tan^2 /
  // 2s^2) at r_max, where sin e = h / r_max: +9 dB. Level pieces alone said "not needed" against the verdict.
  const Outcome outcome = explain(kTown, {"--set", "materials.building.model=\"geometric_optics\"", "--set",
                                          "materials.building.gamma_db=-15.0"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Row row = row_named(rows(), "material building");
  EXPECT_TRUE(row.at("verdict").starts_with("needed")) << row.at("verdict");
  EXPECT_NE(row.at("threshold").find("facing walls +"), std::string::npos) << row.at("threshold");
  EXPECT_NE(row.at("threshold").find("where all four are below 0.1 dB"), std::string::npos)
      << row.at("threshold");
}

TEST_F(Explain, MistakesAreRefusedAsByRender) {
  EXPECT_EQ(explain("[terrain]\n").code, 1);
  const std::string two =
      flat_scene("", 1100, 2000, 20) + "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"b\"\n";
  const std::size_t at = two.find("[radar]");
  const std::string radars = two.substr(0, at) + two.substr(two.find("[frustum]"));
  const Outcome unnamed = explain(radars);
  EXPECT_EQ(unnamed.code, 0) << unnamed.err;
  EXPECT_NE(unnamed.err.find("radar \"a\", the first of the scene's; --radar chooses another"),
            std::string::npos)
      << unnamed.err;
  const Outcome misnamed = explain(radars, {"--radar", "c"});
  EXPECT_EQ(misnamed.code, 1);
  EXPECT_NE(misnamed.err.find("--radar: found \"c\"; allowed: a, b"), std::string::npos) << misnamed.err;
  const Outcome low = explain(flat_scene("", 1100, 2000, 20), {"--set", "antenna.height_m=-5"});
  EXPECT_EQ(low.code, 1);
  EXPECT_NE(low.err.find("below the ground"), std::string::npos) << low.err;
  const Outcome dark = explain(
      flat_scene("", 1100, 2000, 20),
      {"--set", "materials.terrain.model=\"flat_plate\"", "--set", "materials.terrain.plate_tau=0.0"});
  EXPECT_EQ(dark.code, 1);
  EXPECT_NE(dark.err.find("found no power in the bins"), std::string::npos) << dark.err;
  const Outcome silent = explain(flat_scene("", 1100, 2000, 20), {"--set", "radar.power_w=0"});
  EXPECT_EQ(silent.code, 1);
  EXPECT_NE(silent.err.find("radar.power_w = 0, which lights no bin"), std::string::npos) << silent.err;
  const Outcome nadir = explain(flat_scene("", 900, 2000, 20), {"--set", "frustum.kind=oblique"});
  EXPECT_EQ(nadir.code, 1);
  EXPECT_NE(nadir.err.find("radar.r_min_m"), std::string::npos) << nadir.err;
}

TEST_F(Explain, OneOfSeveralRadarsIsExplained) {
  const std::string two =
      "[terrain]\nsynthetic = \"hills\"\ncell_m = 100.0\n"
      "[[radar]]\nname = \"a\"\nr_min_m = 3000\nr_max_m = 6000\nfrustum.kind = \"oblique\"\n"
      "[[radar]]\nname = \"b\"\nr_min_m = 3000\nr_max_m = 6000\nsector_deg = 90\nfrustum.kind = "
      "\"symmetric\"\n"
      "antenna.longitude_deg = -99.45\n"
      "[antenna]\nheight_m = 2500\n[frustum]\npixels = 256\n[bins]\nazimuth = 32\nrange = 32\n";
  const Outcome outcome = explain(two, {"--radar", "b"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("radar b: symmetric frustum"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("building"), outcome.out.find("buildings."));  // only "0 buildings."
}

}  // namespace
}  // namespace obliq::explain_test
