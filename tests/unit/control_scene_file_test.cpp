// Scene files: what they mean, and how every mistake in one is answered.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "server/control/material_library.h"
#include "server/control/parameters.h"
#include "server/control/scene_file.h"
#include "server/control/scene_keys.h"

namespace obliq {
namespace {

constexpr auto kFlat = "[terrain]\nsynthetic = \"flat\"\n";

class SceneFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, const std::string& name = "scene.toml") {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  SceneConfig read(const std::string& text, const std::vector<std::string>& set = {}) {
    return load_scene_file(write(text), {set});
  }
  /// The complaint about a text, with the file's own path shortened to "FILE".
  std::string complaint(const std::string& text, const std::vector<std::string>& set = {}) {
    const auto path = write(text);
    try {
      load_scene_file(path, {set});
    } catch (const InputError& e) {
      std::string what = e.what();
      for (std::size_t at; (at = what.find(path.string())) != std::string::npos;)
        what.replace(at, path.string().size(), "FILE");
      return what;
    }
    return "accepted";
  }
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("obliq_scene_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(SceneFile, NeedsNothingButTerrainAndKeepsTheObliqueFrustum) {
  const SceneConfig config = read(kFlat);
  ASSERT_EQ(config.radars.size(), 1u);
  EXPECT_EQ(config.radars[0].name, "main");
  EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::oblique);
  EXPECT_EQ(config.radars[0].settings.pixel_columns, 2048);
  EXPECT_EQ(config.radars[0].settings.r_max_m, 37000);
  EXPECT_EQ(config.name, "scene");
  EXPECT_EQ(config.server.address, "127.0.0.1");
  EXPECT_EQ(config.server.port, 7420);
  EXPECT_EQ(config.threads, 0);
}

TEST_F(SceneFile, SyntheticGroundIsFlatEarthAtThePapersPlaceUnlessToldOtherwise) {
  const SceneConfig config = read(kFlat);
  EXPECT_TRUE(std::isinf(config.world.radius_factor));
  EXPECT_EQ(config.world.origin.latitude_deg, 33.0);
  EXPECT_EQ(config.world.origin.longitude_deg, -99.5);
  EXPECT_EQ(config.radars[0].pose.latitude_deg, 33.0);
  EXPECT_EQ(read(std::string(kFlat) + "[earth]\nradius_factor = 1\n").world.radius_factor, 1.0);
  const SceneConfig real =
      read("[terrain]\ndem = 'x.tif'\n[antenna]\nlatitude_deg = 10\nlongitude_deg = 20\n");
  EXPECT_DOUBLE_EQ(real.world.radius_factor, 4.0 / 3);
}

TEST_F(SceneFile, ReachIsTheMaximumRangeAndAQuarterAndTheFootprintItsFinestSampling) {
  const SceneConfig config = read(std::string(kFlat) + R"(
[[radar]]
name = "far"
r_min_m = 0
r_max_m = 20480
[[radar]]
name = "near"
r_min_m = 1000
r_max_m = 11240
[radar.bins]
range = 4096
)");
  ASSERT_EQ(config.world.reaches.size(), 2u);
  EXPECT_DOUBLE_EQ(config.world.reaches[0].radius_m, 25600);
  EXPECT_DOUBLE_EQ(config.world.reaches[1].radius_m, 14050);
  EXPECT_DOUBLE_EQ(config.world.sampling_footprint_m,
                   2.5);  // 10,240 m in 4096 bins, not 20,480 m in 2048 rows
}

TEST_F(SceneFile, FootprintIsNeverFinerThanAMetre) {
  const std::string text = std::string(kFlat) + "[radar]\nr_min_m = 1000\nr_max_m = 1100\n";
  EXPECT_DOUBLE_EQ(read(text).world.sampling_footprint_m, 1.0);
}

TEST_F(SceneFile, AntennaSectionsAreDefaultsThatEachRadarMayOverride) {
  const SceneConfig config = read(std::string(kFlat) + R"(
[antenna]
height_m = 2000
bearing_deg = 10
[[radar]]
name = "north"
[[radar]]
name = "south"
sector_deg = 60
antenna.bearing_deg = 190
frustum.pixels = [512, 256]
)");
  ASSERT_EQ(config.radars.size(), 2u);
  EXPECT_EQ(config.radars[0].pose.bearing_deg, 10);
  EXPECT_EQ(config.radars[1].pose.bearing_deg, 190);
  EXPECT_EQ(config.radars[1].pose.height_m, 2000);
  EXPECT_EQ(config.radars[0].settings.sector_deg, 120);
  EXPECT_EQ(config.radars[1].settings.pixel_columns, 512);
  EXPECT_EQ(config.radars[1].settings.pixel_rows, 256);
}

TEST_F(SceneFile, TwoRadarsOfOneNameAreRefused) {
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"a\"\n"),
              "radar.name: found a second \"a\"");
}

TEST_F(SceneFile, FlagsBeatEnvironmentBeatFileBeatDefaults) {
  const std::string text = std::string(kFlat) + "[radar]\nr_max_m = 1e4\nr_min_m = 100\n";
  EXPECT_EQ(read(text).radars[0].settings.r_max_m, 1e4);
  setenv("OBLIQ_RADAR_R_MAX_M", "20000", 1);
  setenv("OBLIQ_FRUSTUM_KIND", "polar", 1);
  const SceneConfig by_environment = read(text);
  const SceneConfig by_flag = read(text, {"radar.r_max_m=25000", "radar.r_max_m=30000"});
  unsetenv("OBLIQ_RADAR_R_MAX_M");
  unsetenv("OBLIQ_FRUSTUM_KIND");
  EXPECT_EQ(by_environment.radars[0].settings.r_max_m, 20000);
  EXPECT_EQ(by_environment.radars[0].settings.frustum, FrustumKind::polar);
  EXPECT_EQ(by_environment.radars[0].settings.r_min_m, 100);
  EXPECT_EQ(by_flag.radars[0].settings.r_max_m, 30000);  // the later flag wins
}

TEST_F(SceneFile, AFlagBeatsARadarsOwnTableAndCanNameOneRadar) {
  const std::string text =
      std::string(kFlat) + "[[radar]]\nname = \"a\"\nfrustum.pixels = 64\n[[radar]]\nname = \"b\"\n";
  const SceneConfig all = read(text, {"frustum.pixels=128"});
  EXPECT_EQ(all.radars[0].settings.pixel_rows, 128);
  EXPECT_EQ(all.radars[1].settings.pixel_rows, 128);
  const SceneConfig one = read(text, {"b:frustum.pixels=[7, 9]", "b:antenna.bearing_deg=45"});
  EXPECT_EQ(one.radars[0].settings.pixel_rows, 64);
  EXPECT_EQ(one.radars[1].settings.pixel_columns, 7);
  EXPECT_EQ(one.radars[1].settings.pixel_rows, 9);
  EXPECT_EQ(one.radars[0].pose.bearing_deg, 0);
  EXPECT_EQ(one.radars[1].pose.bearing_deg, 45);
  EXPECT_SAYS(complaint(text, {"c:bins.range=5"}), "a radar named \"c\"");
}

TEST_F(SceneFile, FlagsReachEverySection) {
  const SceneConfig config =
      read("", {"terrain.synthetic=hills", "terrain.shape.seed=9", "run.threads=3", "server.port=0",
                "materials.terrain.gamma_db=-10", "terrain.cell_m=20"});
  EXPECT_EQ(config.world.terrain.synthetic, SyntheticKind::hills);
  EXPECT_EQ(config.world.terrain.shape.seed, 9u);
  EXPECT_EQ(config.threads, 3);
  EXPECT_EQ(config.server.port, 0);
  EXPECT_DOUBLE_EQ(config.materials[0].gamma, 0.1);
  EXPECT_EQ(config.world.terrain.cell_m, 20.0);
}

TEST_F(SceneFile, WrongFlagsAndVariablesAreNamed) {
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

TEST_F(SceneFile, RelativePathsCountFromTheFileAndGdalsOwnNamesStay) {
  const std::string text = R"(
[terrain]
dem = ["a.tif", "../b.tif", "/data/c.tif", "/vsizip/d.zip/d.tif", "https://example.org/e.tif", 'NETCDF:"f.nc":z']
[antenna]
latitude_deg = 33
longitude_deg = -99.5
[[buildings]]
source = "houses.gpkg"
[[prisms]]
within = "towns.geojson"
)";
  const SceneConfig config = read(text);
  const std::string here = folder_.string() + "/";
  EXPECT_EQ(
      config.world.terrain.dem,
      (std::vector<std::string>{here + "a.tif", (folder_.parent_path() / "b.tif").string(), "/data/c.tif",
                                "/vsizip/d.zip/d.tif", "https://example.org/e.tif", "NETCDF:\"f.nc\":z"}));
  EXPECT_EQ(config.world.buildings.at(0).source, here + "houses.gpkg");
  EXPECT_EQ(config.world.prisms.at(0).within, here + "towns.geojson");
}

TEST_F(SceneFile, AreaIsABoxOrAPolygon) {
  const auto area = [&](const std::string& value) {
    return read(kFlat + ("area = " + value)).world.terrain.area;
  };
  ASSERT_EQ(area("[-100, 32, -99, 33.5]").size(), 4u);
  EXPECT_EQ(area("[-100, 32, -99, 33.5]")[2].latitude_deg, 33.5);
  ASSERT_EQ(area("[[-100, 32], [-99, 32], [-99.5, 33]]").size(), 3u);
  for (const std::string bad :
       {"[1, 2, 3]", "[-99, 32, -100, 33]", "[-100, 32, nan, 33]", "[-100, -95, -99, 33]", "[[1, 2], [3, 4]]",
        "[[0, 0], [1, 1], [2, 2]]", "[[0, 0], [1, 95], [2, 2]]", "\"all\"", "[[0, 0], [1, \"x\"], [2, 2]]",
        "[]", "7"})
    EXPECT_SAYS(complaint(kFlat + ("area = " + bad)), "FILE:3: terrain.area: found");
}

TEST_F(SceneFile, MaterialsAreOverriddenAddedAndNamed) {
  const SceneConfig config = read(std::string(kFlat) + R"(
[materials.building]
reflectivity = 0.25
[materials.sand]
gamma_db = -20
[[surfaces]]
source = "beach.shp"
material = "sand"
[[prisms]]
material = "urban"
)");
  EXPECT_EQ(config.materials.at(0).name, "terrain");
  EXPECT_EQ(config.materials.at(0).gamma, 1.0);
  EXPECT_EQ(config.materials.at(1).reflectivity, 0.25);
  EXPECT_EQ(config.materials.at(1).model, ScatteringModel::geometric_optics);
  const auto sand = find_material(config.materials, "sand");
  ASSERT_TRUE(sand);
  EXPECT_NEAR(config.materials[*sand].gamma, 0.01, 1e-17);
  EXPECT_EQ(config.world.surfaces.at(0).material, *sand);
  EXPECT_EQ(config.world.prisms.at(0).material, *find_material(config.materials, "urban"));
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[prisms]]\nmaterial = \"glass\"\n"),
              "FILE:4: prisms.material: found \"glass\"; allowed: \"terrain\" | \"building\"");
}

TEST_F(SceneFile, UnknownKeysAreRefusedWithTheLineAndTheNearName) {
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

TEST_F(SceneFile, UnknownUnitsAreRefused) {
  EXPECT_SAYS(complaint("[terrain]\ndem = 'x.tif'\nunit = \"furlong\"\n"),
              "FILE:3: terrain.unit: found \"furlong\"; allowed: \"m\" | \"ft\" | \"us_ft\"");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[buildings]]\nsource='x'\nunit = \"storey\"\n"),
              "buildings.unit: found \"storey\"; allowed: \"m\" | \"ft\"");
}

TEST_F(SceneFile, WrongTypesAreRefused) {
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
                                "[frustum]\nkind = \"sweep\"",
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

TEST_F(SceneFile, EveryMistakeOfAFileIsToldAtOnce) {
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

TEST_F(SceneFile, ImpossibleRadarsAreRefused) {
  const auto radar = [&](const std::string& lines) { return complaint(lines + "\n" + kFlat); };
  EXPECT_SAYS(radar("[radar]\nr_min_m = 37000"), "r_min_m less than r_max_m");
  EXPECT_SAYS(radar("[radar]\nsector_deg = 0"), "above 0, at most 360 deg");
  EXPECT_SAYS(radar("[radar]\nsector_deg = 360.1"), "above 0, at most 360 deg");
  EXPECT_SAYS(radar("[frustum]\npixels = 0"), "integer 1 to 16384");
  EXPECT_SAYS(radar("[frustum]\npixels = 1000000"), "integer 1 to 16384");
  EXPECT_SAYS(radar("[frustum]\npixels = [2048, 0]"), "frustum.pixel_rows: found 0");
  EXPECT_SAYS(radar("[bins]\nrange = 0"), "integer 1 to 8192");
  const std::string symmetric = radar("[frustum]\nkind = \"symmetric\"\n[radar]\nsector_deg = 180");
  EXPECT_SAYS(symmetric, "\"oblique\" or \"polar\"");
  EXPECT_SAYS(radar("[antenna]\nheight_reference = \"ellipsoid\""),
              "antenna.geoid_undulation_m: found nothing");
  EXPECT_EQ(radar("[antenna]\nheight_reference = \"ellipsoid\"\ngeoid_undulation_m = 0"), "accepted");
}

TEST_F(SceneFile, TerrainIsNeededAndOnlyOne) {
  EXPECT_SAYS(complaint(""), "FILE: terrain: found neither dem nor synthetic");
  EXPECT_SAYS(complaint("\n\n[terrain]\ncell_m = 5\n"), "FILE:3: terrain: found neither dem nor synthetic");
  EXPECT_SAYS(complaint("[terrain]\ndem='a'\nsynthetic='flat'\n"), "found both dem and synthetic");
  for (const std::string bad : {"''", "[]", "5", "[5]", "['a', '']"})
    EXPECT_SAYS(complaint("[terrain]\ndem = " + bad + "\n"), "FILE:2: terrain.dem: found") << bad;
}

TEST_F(SceneFile, NaNAndInfinityAreRefusedInEveryNumber) {
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
  for (const auto& [key, slot] : scene_entries()) {
    if (!std::holds_alternative<double*>(slot(scene))) continue;
    for (const std::string bad : {"nan", "-nan", "inf", "-inf"}) {
      if (key.name == "earth.radius_factor" && bad == "inf") continue;  // means a flat earth
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

TEST_F(SceneFile, FilesThatAreNoSceneAreRefused) {
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
  EXPECT_SAYS(refusal("/dev/zero"), "found more than 4 MiB");
  EXPECT_SAYS(refusal(""), "cannot be read");
  std::string garbage;
  std::uint32_t state = 1;
  for (int i = 0; i < 5000; ++i) garbage += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  EXPECT_SAYS(refusal(write(garbage)), "scene.toml:1: found something that is not TOML");
  EXPECT_SAYS(refusal(write(std::string(100, '\0'))), "not TOML");
  EXPECT_SAYS(refusal(write("[terrain\n")), "scene.toml:1: found something that is not TOML");
  EXPECT_SAYS(refusal(write("[terrain]\nsynthetic = \"flat\"\nsynthetic = \"hills\"\n")), "scene.toml:3");
}

TEST_F(SceneFile, DeepNestingIsRefusedAndNotRecursedInto) {
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

}  // namespace
}  // namespace obliq
