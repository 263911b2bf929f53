// How every mistake in a scene file, a flag or the environment is answered.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "server/control/parameters.h"
#include "server/control/scene_file.h"
#include "server/control/sections/section.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::bad_scene_test {
namespace {

using BadSceneFile = SceneFile;

TEST_F(BadSceneFile, WrongFlagsAndVariablesAreNamed) {
  EXPECT_SAYS(complaint(kFlat, {"radar.r_max=5"}),
              "--set radar.r_max: radar.r_max: found an unknown key; allowed: did you mean radar.r_max_m?");
  EXPECT_SAYS(complaint(kFlat, {"radar.r_max_m=far"}),
              "--set radar.r_max_m: radar.r_max_m: found far; allowed: number");
  EXPECT_SAYS(complaint(kFlat, {"radar.r_max_m=nan"}), "found nan");
  for (const std::string bad : {"", "=", "x", "radar.=1", ".r=1", "a..b=1", ":radar.r_max_m=1", "radar=1"})
    EXPECT_SAYS(complaint(kFlat, {bad}), "--set") << bad;
  setenv("OBLIQ_RADAR_RMAX_M", "5", 1);
  const std::string unknown = complaint(kFlat);
  unsetenv("OBLIQ_RADAR_RMAX_M");
  EXPECT_SAYS(
      unknown,
      "environment: OBLIQ_RADAR_RMAX_M: found an unknown key; allowed: did you mean OBLIQ_RADAR_R_MAX_M?");
}

TEST_F(BadSceneFile, UnknownKeysAreRefusedWithTheLineAndTheNearName) {
  EXPECT_EQ(complaint(std::string(kFlat) + "[radar]\nrmax_m = 5\n"),
            "FILE:4: radar.rmax_m: found an unknown key; allowed: did you mean radar.r_max_m?");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[radars]\nr_max_m = 5\n"), "did you mean radar?");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[bins]\nxyzzy = 5\n"), "allowed: azimuth, range");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[radar.frustum]\npixel = 5\n"), "frustum.pixel");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[buildings]]\nsource='x'\nheigth_field='h'\n"),
              "did you mean buildings.height_field?");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[materials.x]\ngama_db=1\n"),
              "did you mean materials.x.gamma_db?");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[server]\nports=1\n"), "did you mean server.port?");
  EXPECT_SAYS(complaint("[terrain]\nsynthetic='flat'\n\"a\\u0007b\" = 1\n"), "terrain.\"a\\u0007b\"");
}

TEST_F(BadSceneFile, UnknownUnitsAreRefused) {
  EXPECT_SAYS(complaint("[terrain]\ndem = 'x.tif'\nunit = \"furlong\"\n"),
              "FILE:3: terrain.unit: found \"furlong\"; allowed: \"m\" | \"ft\" | \"us_ft\"");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[buildings]]\nsource='x'\nunit = \"storey\"\n"),
              "buildings.unit: found \"storey\"; allowed: \"m\" | \"ft\"");
}

TEST_F(BadSceneFile, WrongTypesAreRefused) {
  for (const std::string bad : {"[radar]\nr_max_m = \"far\"",
                                "[radar]\nr_max_m = true",
                                "[radar]\nr_max_m = [1]",
                                "[radar]\nr_max_m = {a=1}",
                                "[radar]\nr_max_m = 2020-01-01",
                                "[bins]\nazimuth = 1.5",
                                "[bins]\nazimuth = 1e30",
                                "[radar]\nspeckle = 1",
                                "[radar]\nspeckle = \"gruond\"",
                                "[radar]\nrange_normalisation = 1",
                                "[radar]\nspeckle_seed = 0.5",
                                "[antenna]\npose_id = -1",
                                "[run]\nthreads = -1",
                                "[run]\nthreads = 99999999999",
                                "[server]\naddress = 5",
                                "[server]\nport = 70000",
                                "[frustum]\npixels = []",
                                "[frustum]\npixels = [1, 2, 3]",
                                "[frustum]\npixels = \"many\"",
                                "[frustum]\npixels = 2\npixel_rows = 3",
                                "[frustum]\nkind = \"round\"",
                                "[[terrain]]",
                                "radar = 5",
                                "radar = []",
                                "radar = [5]",
                                "antenna = 5",
                                "earth = 1",
                                "materials = 3",
                                "[materials]\nx = 3",
                                "[[materials]]",
                                "prisms = 1",
                                "[[prisms]]\nwidth_m = [9, 2]",
                                "[[prisms]]\nper_km2 = -1",
                                "[[prisms]]\nwithin = 5",
                                "[[surfaces]]\nsource = 'x'",
                                "[[buildings]]",
                                "[[surfaces]]\nsource='x'\nmaterial='water'\nclasses = [1.5]",
                                "[[radar]]\nname = \"\"",
                                "[[radar]]\nname = \"a b\"",
                                "[[radar]]\nname = 5"}) {
    const bool has_terrain = bad.find("terrain]") != std::string::npos;
    const std::string text = complaint(has_terrain ? bad + "\n" : bad + "\n" + kFlat);
    EXPECT_SAYS(text, "FILE") << bad;
    EXPECT_SAYS(text, "; allowed: ") << bad;
  }
}

TEST_F(BadSceneFile, EveryMistakeOfAFileIsToldAtOnce) {
  const std::string text = complaint(std::string(kFlat) + R"(
[radar]
r_min_m = 5000
r_max_m = 400
sector_deg = 0
colour = 3
[frustum]
pixels = 0
[earth]
radius_factor = nan
)");
  for (const std::string part :
       {"radar.r_min_m: found 5000.0 with radar.r_max_m = 400.0", "FILE:7: radar.sector_deg: found 0",
        "FILE:8: radar.colour: found an unknown key", "FILE:10: frustum.pixel_columns: found 0",
        "FILE:10: frustum.pixel_rows: found 0", "FILE:12: earth.radius_factor: found nan"})
    EXPECT_SAYS(text, part);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
}

TEST_F(BadSceneFile, ImpossibleRadarsAreRefused) {
  const auto radar = [&](const std::string& lines) { return complaint(lines + "\n" + kFlat); };
  EXPECT_SAYS(radar("[radar]\nr_min_m = 37000"), "r_min_m less than r_max_m");
  EXPECT_SAYS(radar("[radar]\nsector_deg = 0"), "above 0, at most 360 deg");
  EXPECT_SAYS(radar("[radar]\nsector_deg = 360.1"), "above 0, at most 360 deg");
  EXPECT_SAYS(radar("[frustum]\npixels = 0"), "integer 1 to 16384");
  EXPECT_SAYS(radar("[frustum]\npixels = 1000000"), "integer 1 to 16384");
  EXPECT_SAYS(radar("[frustum]\npixels = [2048, 0]"), "frustum.pixel_rows: found 0");
  EXPECT_SAYS(radar("[bins]\nrange = 0"), "integer 1 to 8192");
  const std::string symmetric = radar("[frustum]\nkind = \"symmetric\"\n[radar]\nsector_deg = 180");
  EXPECT_SAYS(symmetric, "\"oblique\" or \"sweep\"");
  EXPECT_SAYS(radar("[antenna]\nheight_reference = \"ellipsoid\""),
              "antenna.geoid_undulation_m: found nothing");
  EXPECT_EQ(radar("[antenna]\nheight_reference = \"ellipsoid\"\ngeoid_undulation_m = 0"), "accepted");
}

TEST_F(BadSceneFile, WhatTheSweepCannotDoIsRefusedWithItsRemedy) {
  const auto radar = [&](const std::string& lines) { return complaint(lines + "\n" + kFlat); };
  EXPECT_SAYS(radar("[frustum]\nkind = \"polar\""),
              "FILE:2: frustum.kind: found \"polar\", which only recordings have; allowed: \"symmetric\" | "
              "\"oblique\" | \"sweep\"");
  EXPECT_SAYS(radar("[radar]\nspeckle = \"geometric\""),
              "FILE:2: radar.speckle: found \"geometric\" with frustum.kind = \"sweep\"");
  EXPECT_EQ(radar("[radar]\nspeckle = \"geometric\"\n[frustum]\nkind = \"oblique\""), "accepted");
  const std::string plates = "[materials.steel]\nmodel = \"flat_plate\"\n";
  EXPECT_EQ(radar(plates), "accepted") << "nothing is made of it";
  EXPECT_SAYS(radar("[frustum]\nquality = \"draft\"\n[[prisms]]\nmaterial = \"steel\"\n" + plates),
              "FILE:2: frustum.kind: found \"sweep\" with flat plates (steel); allowed: \"oblique\" or");
  EXPECT_SAYS(radar("[materials.terrain]\nmodel = \"flat_plate\""), "with flat plates (terrain)");
  EXPECT_EQ(radar("[frustum]\nquality = \"paper\"\n[[prisms]]\nmaterial = \"steel\"\n" + plates), "accepted");
}

TEST_F(BadSceneFile, TerrainIsNeededAndOnlyOne) {
  EXPECT_SAYS(complaint(""), "FILE: terrain: found neither dem nor synthetic");
  EXPECT_SAYS(complaint("\n\n[terrain]\ncell_m = 5\n"), "FILE:3: terrain: found neither dem nor synthetic");
  EXPECT_SAYS(complaint("[terrain]\ndem='a'\nsynthetic='flat'\n"), "found both dem and synthetic");
  for (const std::string bad : {"''", "[]", "5", "[5]", "['a', '']"})
    EXPECT_SAYS(complaint("[terrain]\ndem = " + bad + "\n"), "FILE:2: terrain.dem: found") << bad;
}

TEST_F(BadSceneFile, NaNAndInfinityAreRefusedInEveryNumber) {
  int numbers = 0;
  RadarConfig radar;
  for (const Parameter& p : parameters()) {
    if (!std::holds_alternative<double*>(p.slot(radar))) continue;
    for (const std::string bad : {"nan", "-nan", "inf", "-inf"}) {
      const std::string text = complaint(kFlat, {std::string(p.key.name) + "=" + bad});
      EXPECT_SAYS(text, std::string(p.key.name) + ": found ") << bad;
    }
    ++numbers;
  }
  SceneConfig scene;
  for (const auto& [key, slot, change] : scene_rows()) {
    if (!std::holds_alternative<double*>(slot(scene))) continue;
    for (const std::string bad : {"nan", "-nan", "inf", "-inf"}) {
      if (key.name == "earth.radius_factor" && bad == "inf") continue;          // means a flat earth
      if (key.name == "accuracy.max_power_error_db" && bad == "inf") continue;  // means any error
      if (key.name == "server.max_memory_mb" && bad == "inf") continue;         // means no limit
      EXPECT_SAYS(complaint(kFlat, {std::string(key.name) + "=" + bad}), std::string(key.name) + ": found ");
    }
    ++numbers;
  }
  EXPECT_GE(numbers, 18);
  for (const std::string table :
       {"[[prisms]]\nper_km2", "[[prisms]]\nwidth_m", "[[prisms]]\nheight_m", "[terrain]\ncell_m",
        "[[buildings]]\nsource='x'\ndefault_height_m", "[materials.water]\ngamma_db",
        "[materials.x]\nreflectivity", "[materials.x]\nrms_slope", "[materials.x]\nplate_tau",
        "[materials.x]\nplate_exponent"})
    for (const std::string bad : {"nan", "inf", "-inf", "[nan, 1.0]"})
      EXPECT_SAYS(complaint(table + " = " + bad + "\n"), "allowed") << table << bad;
}

TEST_F(BadSceneFile, FilesThatAreNoSceneAreRefused) {
  const auto refusal = [](const std::filesystem::path& path) -> std::string {
    try {
      load_scene_file(path);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_SAYS(refusal(folder_ / "missing.toml"), "missing.toml: cannot be read: No such file or directory");
  EXPECT_SAYS(refusal(folder_), "found a folder");
  EXPECT_SAYS(refusal("/dev/zero"), "found a device");
  EXPECT_SAYS(refusal(""), "cannot be read");
  std::string garbage;
  std::uint32_t state = 1;
  for (int i = 0; i < 5000; ++i) garbage += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  EXPECT_SAYS(refusal(write(garbage)), "scene.toml:1: found something that is not TOML");
  EXPECT_SAYS(refusal(write(std::string(100, '\0'))), "not TOML");
  EXPECT_SAYS(refusal(write("[terrain\n")), "scene.toml:1: found something that is not TOML");
  EXPECT_SAYS(refusal(write("[terrain]\nsynthetic = \"flat\"\nsynthetic = \"hills\"\n")), "scene.toml:3");
}

TEST_F(BadSceneFile, DeepNestingIsRefusedAndNotRecursedInto) {
  std::string dotted = "a";
  for (int i = 0; i < 200000; ++i) dotted += ".a";
  EXPECT_SAYS(complaint(dotted + " = 1\n"), "found a key of more than");
  EXPECT_SAYS(complaint("[" + dotted + "]\n"), "found a key of more than");
  std::string quoted = "\"a\"";
  for (int i = 0; i < 1000; ++i) quoted += ".\"/\"";
  EXPECT_SAYS(complaint(quoted + " = 1\n"), "found a key of more than");
  EXPECT_SAYS(complaint("x = " + std::string(100, '[') + std::string(100, ']') + "\n"), "deep");
  EXPECT_SAYS(complaint("x = " + std::string(100000, '[') + "\n"), "not TOML");
  EXPECT_SAYS(complaint(kFlat, {"radar.r_max_m=" + std::string(50, '[') + std::string(50, ']')}), "deep");
}

TEST_F(BadSceneFile, MillionsOfKeysAreRefusedByTheirCount) {
  const auto many = [](int n, const std::string& before, const std::string& after) {
    std::string text;
    for (int k = 0; k < n; ++k) text += before + std::to_string(k) + after;
    return text;
  };
  EXPECT_SAYS(complaint("[beam]\n" + many(300'000, "k", " = 1\n")),
              "FILE: found about 300001 values; allowed: at most 100000");
  EXPECT_SAYS(complaint("[terrain]\ndem = [" + many(300'000, "'", "',") + "]\n"),
              "found about 300002 values");
  EXPECT_SAYS(complaint(kFlat + many(100'000, "[[radar]]\nname='r", "'\n")), "found about 200002 values");
  // Below that, what is told of is bounded, and so is the looking for near names.
  const std::string unknown = complaint(std::string(kFlat) + "[beam]\n" + many(90'000, "k", " = 1\n"));
  EXPECT_EQ(std::count(unknown.begin(), unknown.end(), '\n'), 100);
  EXPECT_TRUE(unknown.ends_with("\nand 89900 more complaints")) << unknown.substr(unknown.size() - 100);
  const std::string radars = complaint(kFlat + many(30'000, "[[radar]]\nname='r", "'\n"));
  EXPECT_EQ(radars, "FILE: radar: found 30000 radars; allowed: at most 16 (server.max_radars)");
}

TEST_F(BadSceneFile, NothingIsShownOfAFileThatIsNoScene) {
  for (const std::string secret : {"root:$y$j9T$w0rd:19000:0:99999:7:::\n", "PASSWORD hunter2\n",
                                   "-----BEGIN PRIVATE KEY-----\nMIIEvQIBADANBg\n", "MIIEvQIBADANBg==\n"}) {
    const std::string text = complaint(secret);
    EXPECT_SAYS(text, "FILE:");
    EXPECT_SAYS(text, "not TOML");
    EXPECT_EQ(text.find("saw"), std::string::npos) << text;
  }
  write("root:$y$j9T$w0rd:19000:0:99999:7:::\n", "shadow.csv");
  const std::string beam =
      complaint(std::string(kFlat) + "[beam]\npattern = \"file\"\nfile = \"shadow.csv\"\n");
  EXPECT_SAYS(
      beam, "shadow.csv:1: beam.file: found another first line; allowed: the heading cut,angle_deg,gain_db");
}

TEST_F(BadSceneFile, ANulInAPathIsNamed) {
  const std::pair<std::string, std::string> keys[] = {{"[beam]\nfile", "beam.file"},
                                                      {"[server]\ntokens", "server.tokens"},
                                                      {"[[buildings]]\nsource", "buildings.source"}};
  for (const auto& [line, key] : keys)
    EXPECT_SAYS(complaint(std::string(kFlat) + line + " = \"a\\u0000b\"\n"),
                "FILE:4: " + key + ": found \"a\\u0000b\"; allowed: a text without the character U+0000");
}

TEST_F(BadSceneFile, APassOfLessThanTenMillisecondsIsRefused) {
  const auto scan = [&](const std::string& sector, const std::string& rate) {
    return complaint(std::string(kFlat) + "[radar]\nsector_deg = " + sector +
                     "\n[scan]\nmode = \"sector\"\nrate_deg_s = " + rate + "\n");
  };
  EXPECT_EQ(
      scan("0.01", "7200"),
      "FILE:7: scan.rate_deg_s: found 7200.0 with radar.sector_deg = 0.01; allowed: a pass over the sector "
      "in at least 0.01 s: at most 1.0 deg/s, or a sector of at least 72.0 deg");
  EXPECT_EQ(scan("72", "7200"), "accepted");
  EXPECT_EQ(scan("71.9", "7200").find("FILE:7: scan.rate_deg_s"), 0u);
  // Without a scan its rate means nothing.
  EXPECT_EQ(complaint(std::string(kFlat) + "[radar]\nsector_deg = 0.01\n[scan]\nrate_deg_s = 7200\n"),
            "accepted");
}

}  // namespace
}  // namespace obliq::bad_scene_test
