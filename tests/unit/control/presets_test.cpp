// radar.preset: whole radars, what overrides them, and how mistakes are answered.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "server/control/parameter_reference.h"
#include "server/control/parameters.h"
#include "server/control/radar_presets.h"
#include "server/control/scene_file.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::presets_test {
namespace {

class Presets : public SceneFile {
 protected:
  RadarConfig radar(const std::string& text, const std::vector<std::string>& set = {}) {
    return read(kFlat + text, set).radars[0];
  }
};

TEST_F(Presets, AreTheSixAndEachIsAValidRadar) {
  std::vector<std::string_view> names;
  for (const RadarPreset& preset : radar_presets()) {
    names.push_back(preset.name);
    const std::string scene = "[radar]\npreset = \"" + std::string(preset.name) + "\"\n";
    EXPECT_EQ(complaint(kFlat + scene), "accepted");
    const RadarConfig found = radar(scene);
    EXPECT_EQ(found.settings.frustum, FrustumKind::sweep) << preset.name;
    EXPECT_TRUE(found.settings.receiver.noise) << preset.name;
    EXPECT_NE(found.settings.beam.pattern, BeamPattern::off) << preset.name;
    EXPECT_NE(found.settings.scan_mode, ScanMode::frame) << preset.name;
  }
  EXPECT_EQ(names, (std::vector<std::string_view>{"fighter_x", "mapping_ka", "marine_s", "marine_x",
                                                  "patrol_x", "surveillance_l"}));
}

TEST_F(Presets, HaveASourceOrAssumedBesideEachFigureWhereTheHeadNamesNone) {
  for (const RadarPreset& preset : radar_presets()) {
    std::istringstream lines{std::string(preset.text)};
    std::string head;
    int keys = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("#")) {
        head += line;
        continue;
      }
      ++keys;
      // Two ways: a comment of its own, or a head that names one radar and its source.
      const bool said = line.find(" # ") != std::string::npos;
      const bool by_head = head.find("where no other") != std::string::npos;
      const bool is_figure = line.find_first_of("0123456789", line.find('=')) != std::string::npos;
      EXPECT_TRUE(said || by_head || !is_figure || line == "radar.sector_deg = 360.0")
          << preset.name << ": " << line;
    }
    EXPECT_GE(keys, 15) << preset.name;
    EXPECT_LE(keys, 25) << preset.name;
    EXPECT_TRUE(head.find("source") != std::string::npos) << preset.name;
  }
}

/// 26,000 / (azimuth x elevation beamwidth in degrees): Stutzman and Thiele's rule, which the files name.
TEST_F(Presets, GainsFollowFromTheBeams) {
  for (const RadarPreset& preset : radar_presets()) {
    const RadarSettings s = radar("[radar]\npreset = \"" + std::string(preset.name) + "\"\n").settings;
    EXPECT_NEAR(s.gain_db, 10 * std::log10(26000 / (s.beam.width_deg * s.beam.elevation_width_deg)), 0.06)
        << preset.name;
  }
}

TEST_F(Presets, FillOnlyWhatNoKeyOfTheSceneNames) {
  const RadarConfig alone = radar("[radar]\npreset = \"marine_x\"\n");
  EXPECT_EQ(alone.settings.r_max_m, 11112);
  EXPECT_EQ(alone.pose.height_reference, HeightReference::ground);
  EXPECT_EQ(alone.settings.scan_mode, ScanMode::circular);

  const RadarConfig own = radar("[radar]\npreset = \"marine_x\"\nr_max_m = 5556.0\nbeam.width_deg = 2.0\n");
  EXPECT_EQ(own.settings.r_max_m, 5556);
  EXPECT_EQ(own.settings.beam.width_deg, 2);
  EXPECT_EQ(own.settings.beam.sidelobe_db, alone.settings.beam.sidelobe_db)
      << "the rest of the section stays";
  EXPECT_EQ(own.settings.frequency_ghz, alone.settings.frequency_ghz);

  const RadarConfig shared = radar("[beam]\nwidth_deg = 2.5\n[radar]\npreset = \"marine_x\"\n");
  EXPECT_EQ(shared.settings.beam.width_deg, 2.5) << "sections of all radars override it too";
  EXPECT_EQ(radar("[radar]\npreset = \"marine_x\"\n", {"radar.r_max_m=1852"}).settings.r_max_m, 1852);
  EXPECT_EQ(radar("[frustum]\nquality = \"draft\"\n[radar]\npreset = \"marine_x\"\n").settings.pixel_columns,
            1024);
}

TEST_F(Presets, OfSeveralRadarsAreEachTheirOwn) {
  const SceneConfig scene =
      read(std::string(kFlat) +
           "[[radar]]\nname = \"nose\"\npreset = \"fighter_x\"\n"
           "[[radar]]\nname = \"bridge\"\npreset = \"marine_s\"\n[[radar]]\nname = \"plain\"\n");
  EXPECT_EQ(scene.radars[0].settings.frequency_ghz, 9.8);
  EXPECT_EQ(scene.radars[1].settings.frequency_ghz, 3.05);
  EXPECT_EQ(scene.radars[2].settings.frequency_ghz, RadarSettings{}.frequency_ghz);
  EXPECT_EQ(scene.radars[2].settings.beam.pattern, BeamPattern::off);
}

TEST_F(Presets, GoByAFlagForOneRadarOrAll) {
  const std::string two =
      std::string(kFlat) + "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"b\"\nr_max_m = 9000.0\n";
  const SceneConfig one = read(two, {"b:radar.preset=marine_x"});
  EXPECT_EQ(one.radars[0].settings.frequency_ghz, RadarSettings{}.frequency_ghz);
  EXPECT_EQ(one.radars[1].settings.frequency_ghz, 9.41);
  EXPECT_EQ(one.radars[1].settings.r_max_m, 9000)
      << "the file's key overrides the preset wherever it is named";
  EXPECT_EQ(read(two, {"radar.preset=marine_s"}).radars[0].settings.frequency_ghz, 3.05);
}

TEST_F(Presets, SixLinesAreARadarOverAPlace) {
  const SceneConfig scene = read(
      "terrain.synthetic = \"hills\"\nantenna.latitude_deg = 34.02\nantenna.longitude_deg = -118.46\n"
      "antenna.height_m = 1500.0\nantenna.bearing_deg = 60.0\nradar.preset = \"fighter_x\"\n");
  EXPECT_EQ(scene.radars[0].pose.latitude_deg, 34.02);
  EXPECT_EQ(scene.radars[0].pose.height_m, 1500);
  EXPECT_EQ(scene.radars[0].pose.height_reference, HeightReference::ground);
  EXPECT_EQ(scene.radars[0].settings.beam.width_deg, 2.9);
}

TEST_F(Presets, PrintedConfigurationIsTheSameRadarWithoutThePreset) {
  const SceneConfig scene = read(std::string(kFlat) + "[radar]\npreset = \"surveillance_l\"\n");
  const std::string printed = print_config(scene);
  EXPECT_EQ(printed.find("preset"), std::string::npos);
  const SceneConfig again = read(printed);
  for (const Parameter& parameter : parameters())
    EXPECT_EQ(value_of(parameter, again.radars[0]), value_of(parameter, scene.radars[0]))
        << parameter.key.name;
}

TEST_F(Presets, UnknownOnesNameWhatThereIs) {
  const std::string allowed =
      "; allowed: \"fighter_x\" | \"mapping_ka\" | \"marine_s\" | \"marine_x\" | \"patrol_x\" | "
      "\"surveillance_l\"";
  EXPECT_EQ(complaint(std::string(kFlat) + "[radar]\npreset = \"marine\"\n"),
            "FILE:4: radar.preset: found \"marine\"" + allowed);
  EXPECT_SAYS(complaint(std::string(kFlat) + "[radar]\npreset = 3\n"), "radar.preset: found 3" + allowed);
  EXPECT_SAYS(complaint(std::string(kFlat) + "[radar]\npreset = [\"marine_x\"]\n"),
              "radar.preset: found a list");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[radar]\nperset = \"marine_x\"\n"),
              "did you mean radar.preset?");
  EXPECT_SAYS(complaint(kFlat, {"radar.preset=fighter"}), "radar.preset: found fighter" + allowed);
  EXPECT_THROW(preset_text("marine"), InputError);
}

TEST_F(Presets, AKeyThatDoesNotFitThePresetIsNamedWithThePresetsLine) {
  const std::string said =
      complaint(std::string(kFlat) + "[radar]\npreset = \"fighter_x\"\nsector_deg = 4.0\n");
  EXPECT_SAYS(said, "preset fighter_x:");
  EXPECT_SAYS(said, "beam.width_deg: found 2.9 with radar.sector_deg = 4.0");
}

TEST_F(Presets, ArePrintedAsTheyAreWithTheirSources) {
  for (const RadarPreset& preset : radar_presets()) {
    EXPECT_EQ(preset_text(preset.name), preset.text);
    EXPECT_FALSE(first_sentence(preset).empty());
    EXPECT_SAYS(parameters_markdown(), std::string(first_sentence(preset)));
  }
}

}  // namespace
}  // namespace obliq::presets_test
