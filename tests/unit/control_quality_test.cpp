// frustum.quality in every layer, and [accuracy].
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "server/control/quality_presets.h"
#include "server/control/scene_file.h"
#include "tests/unit/scene_file_fixture.h"

namespace obliq {
namespace {

class Quality : public SceneFile {
 protected:
  RadarSettings settings(const std::string& text, const std::vector<std::string>& set = {}) {
    return read(std::string(kFlat) + text, set).radars[0].settings;
  }
};

TEST_F(Quality, PaperIsThePapersSamplingWhateverTheBins) {
  const RadarSettings s = settings("[frustum]\nquality = \"paper\"\n[bins]\nazimuth = 64\nrange = 32\n");
  EXPECT_EQ(s.frustum, FrustumKind::oblique);
  EXPECT_EQ(s.plates, PlateKind::nearest);
  EXPECT_EQ(s.pixel_columns, 2048);
  EXPECT_EQ(s.pixel_rows, 2048);
}

TEST_F(Quality, NoFrustumAtAllMeansStandardAndIsSaid) {
  const SceneConfig config = read(kFlat);
  const RadarSettings standard = settings("[frustum]\nquality = \"standard\"\n");
  EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::sweep);
  EXPECT_EQ(config.radars[0].settings.pixel_columns, standard.pixel_columns);
  ASSERT_EQ(config.notes.size(), 1u);
  EXPECT_EQ(config.notes[0],
            "no frustum named: sweep \"standard\"; frustum.kind = \"oblique\" casts rays with Embree");
  EXPECT_EQ(settings("[frustum]\n").frustum, FrustumKind::sweep) << "an empty table names nothing";
  EXPECT_EQ(settings("[bins]\nazimuth = 64\n").pixel_columns, 128);
  EXPECT_EQ(settings("[bins]\nazimuth = 64\n", {"bins.azimuth=32"}).pixel_columns, 64);
}

TEST_F(Quality, PixelsOrPlatesAloneMeanTheObliqueFrustumAndThatIsSaid) {
  for (const std::string key :
       {"pixels = 300", "pixel_columns = 300", "pixel_rows = 300", "plates = \"nearest\""}) {
    const SceneConfig config = read(std::string(kFlat) + "[frustum]\n" + key + "\n");
    EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::oblique) << key;
    ASSERT_EQ(config.notes.size(), 1u) << key;
    EXPECT_NE(config.notes[0].find("frustum.kind is not named: \"oblique\""), std::string::npos)
        << config.notes[0];
  }
  EXPECT_EQ(read(kFlat, {"frustum.pixels=300"}).radars[0].settings.frustum, FrustumKind::oblique);
  EXPECT_EQ(read(std::string(kFlat) + "[frustum]\nkind = \"symmetric\"\n").notes.size(), 0u);
  EXPECT_EQ(read(std::string(kFlat) + "[frustum]\npixels = 300\n", {"frustum.quality=draft"}).notes.size(),
            0u);
}

TEST_F(Quality, OfSeveralRadarsThoseWithoutAFrustumAreNamed) {
  const SceneConfig config = read(std::string(kFlat) + "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"b\"\n" +
                                  "frustum.kind = \"oblique\"\n[[radar]]\nname = \"c\"\n");
  EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::sweep);
  EXPECT_EQ(config.radars[1].settings.frustum, FrustumKind::oblique);
  ASSERT_EQ(config.notes.size(), 1u);
  EXPECT_EQ(config.notes[0].rfind("radar a, c: no frustum named", 0), 0u) << config.notes[0];
}

TEST_F(Quality, ObliqueIsToFindItsPixelsUnlessTheyAreNamed) {
  const std::string quality = "[frustum]\nquality = \"oblique\"\n";
  const RadarConfig radar = read(std::string(kFlat) + quality).radars[0];
  EXPECT_EQ(radar.settings.frustum, FrustumKind::oblique);
  EXPECT_EQ(radar.settings.plates, PlateKind::spread);
  EXPECT_TRUE(radar.finds_pixels);
  EXPECT_FALSE(read(std::string(kFlat) + quality + "pixels = 300\n").radars[0].finds_pixels);
  EXPECT_FALSE(read(std::string(kFlat) + quality, {"frustum.pixels=300"}).radars[0].finds_pixels);
  EXPECT_FALSE(read(std::string(kFlat) + quality, {"frustum.kind=symmetric"}).radars[0].finds_pixels);
  EXPECT_TRUE(read(kFlat, {"frustum.quality=oblique"}).radars[0].finds_pixels);
  EXPECT_FALSE(
      read(std::string(kFlat) + quality + "[[radar]]\nfrustum.pixels = 300\n").radars[0].finds_pixels);
  const std::string printed = print_config(read(std::string(kFlat) + quality));
  EXPECT_NE(printed.find("quality = \"oblique\""), std::string::npos) << printed;
  EXPECT_TRUE(read(printed).radars[0].finds_pixels) << "what is printed can be read again";
}

TEST_F(Quality, TheOthersFollowTheBinsWhereverTheseAreSet) {
  const QualityPreset* standard = find_quality("standard");
  ASSERT_NE(standard, nullptr);
  const auto expected = [&](int azimuth_bins) {
    return static_cast<int>(std::lround(standard->columns_per_bin * azimuth_bins));
  };
  const std::string quality = "[frustum]\nquality = \"standard\"\n";
  EXPECT_EQ(settings(quality).pixel_columns, expected(1024));  // the default number of bins
  EXPECT_EQ(settings(quality + "[bins]\nazimuth = 100\n").pixel_columns, expected(100));
  EXPECT_EQ(settings(quality + "[bins]\nazimuth = 100\n", {"bins.azimuth=300"}).pixel_columns, expected(300));
  EXPECT_EQ(settings("[radar]\nfrustum.quality = \"standard\"\nbins.azimuth = 50\n").pixel_columns,
            expected(50));
  // 16 x 8192 columns would be too many.
  EXPECT_LE(settings("[frustum]\nquality = \"reference\"\n[bins]\nazimuth = 8192\n").pixel_columns, 16384);
}

TEST_F(Quality, EachRadarHasTheBinsOfItsOwn) {
  const SceneConfig config = read(std::string(kFlat) +
                                  "[frustum]\nquality = \"draft\"\n[bins]\nazimuth = 40\n"
                                  "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"b\"\nbins.azimuth = 60\n"
                                  "[[radar]]\nname = \"c\"\nfrustum.pixel_columns = 7\n");
  const double per_bin = find_quality("draft")->columns_per_bin;
  EXPECT_EQ(config.radars[0].settings.pixel_columns, std::lround(40 * per_bin));
  EXPECT_EQ(config.radars[1].settings.pixel_columns, std::lround(60 * per_bin));
  EXPECT_EQ(config.radars[2].settings.pixel_columns, 7);
}

TEST_F(Quality, KeysOfTheSameLayerWin) {
  const RadarSettings file =
      settings("[frustum]\nkind = \"symmetric\"\nquality = \"draft\"\npixels = [30, 20]\n");
  EXPECT_EQ(file.frustum, FrustumKind::symmetric);
  EXPECT_EQ(file.pixel_columns, 30);
  EXPECT_EQ(file.pixel_rows, 20);
  for (const auto& flags : {std::vector<std::string>{"frustum.quality=draft", "frustum.kind=symmetric"},
                            std::vector<std::string>{"frustum.kind=symmetric", "frustum.quality=draft"}})
    EXPECT_EQ(settings("", flags).frustum, FrustumKind::symmetric) << flags[0];
}

TEST_F(Quality, ALaterLayerWinsOverTheKeysOfAnEarlierOne) {
  // A scene that names its frustum can still be tried at another quality.
  const std::string scene = "[frustum]\nkind = \"symmetric\"\npixels = 300\n";
  const RadarSettings s = settings(scene, {"frustum.quality=paper"});
  EXPECT_EQ(s.frustum, FrustumKind::oblique);
  EXPECT_EQ(s.pixel_columns, 2048);
  setenv("OBLIQ_FRUSTUM_QUALITY", "paper", 1);
  setenv("OBLIQ_FRUSTUM_PIXEL_ROWS", "90", 1);
  const RadarSettings by_environment = settings(scene);
  const RadarSettings by_flag = settings(scene, {"frustum.plates=spread"});
  unsetenv("OBLIQ_FRUSTUM_QUALITY");
  unsetenv("OBLIQ_FRUSTUM_PIXEL_ROWS");
  EXPECT_EQ(by_environment.frustum, FrustumKind::oblique);
  EXPECT_EQ(by_environment.plates, PlateKind::nearest);
  EXPECT_EQ(by_environment.pixel_columns, 2048);
  EXPECT_EQ(by_environment.pixel_rows, 90);
  EXPECT_EQ(by_flag.plates, PlateKind::spread);
}

TEST_F(Quality, AnUnknownOneIsRefusedWithTheNames) {
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nquality = \"best\"\n"), "frustum.quality");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nquality = 3\n"), "\"reference\"");
  EXPECT_SAYS(complaint(kFlat, {"frustum.quality=ultra"}), "frustum.quality");
}

TEST_F(Quality, PrintConfigShowsWhatItBecame) {
  const std::string text =
      print_config(read(std::string(kFlat) + "[frustum]\nquality = \"paper\"\n[bins]\nazimuth = 64\n"));
  EXPECT_EQ(text.find("\nquality = "), std::string::npos);
  EXPECT_NE(text.find("plates = \"nearest\""), std::string::npos) << text;
}

TEST_F(Quality, AccuracyIsAnyUnlessAsked) {
  EXPECT_FALSE(read(kFlat).accuracy.asks());
  const SceneConfig config =
      read(std::string(kFlat) + "[accuracy]\nmax_power_error_db = 0.2\n", {"accuracy.max_gap_fraction=0.01"});
  EXPECT_TRUE(config.accuracy.asks());
  EXPECT_EQ(config.accuracy.max_power_error_db, 0.2);
  EXPECT_EQ(config.accuracy.max_gap_fraction, 0.01);
  // An error alone is meant for nearly all bins; 1 asks for no limit, in so many words.
  EXPECT_EQ(read(kFlat).accuracy.max_gap_fraction, 1);
  EXPECT_EQ(read(kFlat, {"accuracy.max_power_error_db=0.5"}).accuracy.max_gap_fraction, 0.05);
  EXPECT_EQ(read(kFlat, {"accuracy.max_power_error_db=0.5", "accuracy.max_gap_fraction=1"})
                .accuracy.max_gap_fraction,
            1);
  EXPECT_SAYS(complaint(kFlat, {"main:accuracy.max_gap_fraction=0.1"}), "no radar parameter");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[accuracy]\nmax_gap_fraction = 2\n"),
              "accuracy.max_gap_fraction");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[accuracy]\nmax_power_error_db = -1\n"),
              "accuracy.max_power_error_db");
}

}  // namespace
}  // namespace obliq
