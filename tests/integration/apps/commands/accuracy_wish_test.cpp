// [accuracy]: pixels and cell size that follow from the error a user allows.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "tests/integration/daemon.h"

namespace obliq::accuracy_wish_test {
namespace {

using test::text_of;

constexpr const char* kScene =
    "[terrain]\nsynthetic = \"hills\"\n[terrain.shape]\nheight_m = 300.0\n[antenna]\nheight_m = 900.0\n"
    "[radar]\nsector_deg = 40.0\nr_min_m = 1500.0\nr_max_m = 4000.0\n[bins]\nazimuth = 16\nrange = 32\n";

class AccuracyWish : public test::ProgramTest {
 protected:
  test::Outcome render(const std::vector<std::string>& set) const {
    std::vector<std::string> more;
    for (const std::string& flag : set) more.insert(more.end(), {"--set", flag});
    return obliq({"render", folder.write("scene.toml", kScene), "--out", folder / "files"}, more);
  }

  /// The number behind some words of a text; -1 when they are not there.
  static double number_after(const std::string& text, const std::string& words) {
    std::smatch found;
    return std::regex_search(text, found, std::regex(words + "([0-9.]+)")) ? std::stod(found[1]) : -1;
  }
};

TEST_F(AccuracyWish, WhatIsAskedIsMetForEveryKindAndToldWithItsMeasure) {
  for (const std::string kind : {"oblique", "sweep"}) {
    const auto run =
        render({"frustum.kind=" + kind, "accuracy.max_power_error_db=0.3", "accuracy.max_gap_fraction=0.02"});
    ASSERT_EQ(run.code, 0) << run.err;
    const double median_db = number_after(run.err, "median error ");
    EXPECT_GT(median_db, 0) << run.err;
    EXPECT_LE(median_db, 0.3) << run.err;
    EXPECT_LE(number_after(run.err, " dB, gaps "), 2) << run.err;  // percent
    EXPECT_NE(run.err.find("accuracy: radar \"main\": " + kind + " "), std::string::npos) << run.err;
    // What was chosen is what was rendered.
    const double columns = number_after(run.err, "accuracy: radar \"main\": " + kind + " ");
    const std::string json = text_of(folder / "files" / "frame.json");
    EXPECT_EQ(number_after(json, "\"pixel_columns\": "), columns) << json;
    EXPECT_NE(
        run.err.find("posts of " + std::to_string(static_cast<int>(number_after(run.err, "over cells of ")))),
        std::string::npos)
        << run.err;
  }
}

TEST_F(AccuracyWish, QualityObliqueFindsPixelsThatLeaveFewLitBinsUnsampled) {
  const auto run = render({"frustum.quality=oblique", "terrain.cell_m=20"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find("radar \"main\": frustum.quality \"oblique\": "), std::string::npos) << run.err;
  const std::string json = text_of(folder / "files" / "frame.json");
  EXPECT_NE(json.find("\"frustum\": \"oblique\""), std::string::npos);
  const double lit = number_after(json, "\"lit_bins\": ");
  EXPECT_GT(lit, 200);
  EXPECT_LE(number_after(json, "\"unsampled_bins\": "), 0.03 * lit);
  EXPECT_EQ(number_after(run.err, "\"oblique\": "), number_after(json, "\"pixel_columns\": ")) << run.err;
  EXPECT_NE(json.find("\"warnings\": []"), std::string::npos);
}

TEST_F(AccuracyWish, QualityObliqueSaysWhyNoPixelsDo) {
  const auto limited = render({"frustum.quality=oblique", "bins.azimuth=512", "bins.range=512",
                               "server.max_pixels=300000", "terrain.cell_m=20"});
  EXPECT_EQ(limited.code, 1);
  EXPECT_NE(limited.err.find("512 x 512 pixels, the most that server.max_pixels allows, leave "),
            std::string::npos)
      << limited.err;
  EXPECT_NE(limited.err.find("frustum.quality = \"standard\", the sweep"), std::string::npos) << limited.err;
  const auto low = render({"frustum.quality=oblique", "terrain.synthetic=ridge",
                           "terrain.shape.distance_m=2500", "terrain.cell_m=20", "antenna.height_m=100"});
  EXPECT_EQ(low.code, 1);
  EXPECT_NE(low.err.find("below the highest ground"), std::string::npos) << low.err;
  EXPECT_NE(low.err.find("frustum.quality = \"standard\", the sweep"), std::string::npos) << low.err;
}

TEST_F(AccuracyWish, ASceneWithoutAFrustumIsSweptAndSaysSo) {
  const auto run = render({});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find(
                "no frustum named: sweep \"standard\"; frustum.kind = \"oblique\" casts rays with Embree\n"),
            std::string::npos)
      << run.err;
  EXPECT_NE(text_of(folder / "files" / "frame.json").find("\"frustum\": \"sweep\""), std::string::npos);
}

TEST_F(AccuracyWish, FewPixelsAreWarnedOfOnStderr) {
  const auto run = render({"frustum.kind=oblique", "frustum.pixels=20", "bins.azimuth=64"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find(" % of the lit bins ("), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("hold no sample: frustum.quality = \"standard\""), std::string::npos) << run.err;
}

TEST_F(AccuracyWish, AskingForMoreTakesMore) {
  const auto columns = [&](const std::string& limit_db) {
    const auto run = render({"frustum.kind=oblique", "terrain.cell_m=20", "bins.azimuth=128",
                             "bins.range=128", "accuracy.max_power_error_db=" + limit_db});
    EXPECT_EQ(run.code, 0) << run.err;
    return number_after(run.err, "oblique ");
  };
  EXPECT_LT(columns("1.5"), columns("0.1"));
}

TEST_F(AccuracyWish, ACellSizeOfTheUsersOwnStays) {
  const auto run = render({"frustum.kind=sweep", "terrain.cell_m=48", "accuracy.max_power_error_db=3"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(number_after(run.err, "over cells of "), 48) << run.err;
}

TEST_F(AccuracyWish, WhatCannotBeMetIsRefusedWithTheBestThatWasReached) {
  // A grid of 400 m cells is metres off the hills whatever the sampling.
  const auto run = render({"frustum.kind=sweep", "terrain.cell_m=400", "accuracy.max_power_error_db=0.0001"});
  EXPECT_NE(run.code, 0);
  EXPECT_NE(run.err.find("max_power_error_db = 0.0001 and max_gap_fraction = 0.05; allowed: at best a median "
                         "error of "),
            std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("ask for a larger error"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "files" / "bins.npy"));
}

// No light, no error: an empty frame must not pass for a perfect one.
TEST_F(AccuracyWish, WhereNothingIsLitNothingIsPromised) {
  const auto run = render({"radar.power_w=0", "accuracy.max_power_error_db=0.5"});
  EXPECT_NE(run.code, 0);
  EXPECT_NE(run.err.find("nothing is lit here: nothing to compare"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("median error"), std::string::npos) << run.err;
}

TEST_F(AccuracyWish, PixelsThatTheSceneNamedAndThatAreNotTakenAreTold) {
  const auto run = render({"frustum.kind=oblique", "frustum.pixels=300", "accuracy.max_power_error_db=3"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find("frustum.pixels 300 x 300 -> "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("(chosen by [accuracy])"), std::string::npos) << run.err;
}

TEST_F(AccuracyWish, NothingAskedMeasuresNothing) {
  const auto run = render({"frustum.pixels=64"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err.find("accuracy"), std::string::npos) << run.err;
}

TEST_F(AccuracyWish, TheDaemonSaysWhatItChose) {
  const std::string scene = folder.write("scene.toml", kScene);
  const test::Daemon daemon({"--config", scene, "--port", "0", "--set", "frustum.quality=draft", "--set",
                             "accuracy.max_power_error_db=1"},
                            folder.path());
  ASSERT_FALSE(daemon.address().empty()) << daemon.log();
  EXPECT_NE(daemon.log().find("accuracy: radar \"main\": sweep "), std::string::npos) << daemon.log();
}

}  // namespace
}  // namespace obliq::accuracy_wish_test
