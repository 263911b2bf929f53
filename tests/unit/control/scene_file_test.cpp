// What scene files mean.
#include "server/control/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "server/control/sections/materials.h"
#include "terrain/cache/ground_cache.h"
#include "tests/unit/control/scene_file_fixture.h"
#include "tests/unit/terrain_files.h"

namespace obliq::scene_file_test {
namespace {

TEST_F(SceneFile, NeedsNothingButTerrainAndIsSweptThen) {
  const SceneConfig config = read(kFlat);
  ASSERT_EQ(config.radars.size(), 1u);
  EXPECT_EQ(config.radars[0].name, "main");
  EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::sweep);
  EXPECT_EQ(config.radars[0].settings.pixel_columns, 2048);  // two an azimuth bin
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

TEST_F(SceneFile, AnAntennaWithoutAPositionStandsAtTheElevationModelsCentre) {
  const test::Folder folder;
  const auto level = [](double, double) { return 7.0; };
  write_raster(folder, "dem.tif", test::around(-101.25, 35.5, level));
  const auto place = [&](const std::string& antenna) {
    const SceneConfig config =
        load_scene_file(folder.text("scene.toml", "[terrain]\ndem = \"dem.tif\"\n[antenna]\n" + antenna));
    EXPECT_EQ(config.world.origin.latitude_deg, config.radars[0].pose.latitude_deg);
    return LonLat{config.radars[0].pose.longitude_deg, config.radars[0].pose.latitude_deg};
  };
  constexpr double kPixel_deg = 1.0 / 1200;  // the centre may be that of a pixel or of the whole
  EXPECT_NEAR(place("").longitude_deg, -101.25, kPixel_deg);
  EXPECT_NEAR(place("").latitude_deg, 35.5, kPixel_deg);
  EXPECT_EQ(place("latitude_deg = 35.51").latitude_deg, 35.51);
  EXPECT_NEAR(place("latitude_deg = 35.51").longitude_deg, -101.25, kPixel_deg);
  // A file that is not there is looked for only when its centre is needed.
  std::filesystem::remove(folder.file("dem.tif"));
  EXPECT_EQ(place("latitude_deg = 1\nlongitude_deg = 2").longitude_deg, 2);
  EXPECT_THROW(place("latitude_deg = 1"), InputError);
}

TEST_F(SceneFile, ReachIsTheMaximumRangeAndAQuarterAndTheFootprintItsFinestSampling) {
  const SceneConfig config = read(std::string(kFlat) + R"(
[frustum]
kind = "oblique"
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
  setenv("OBLIQ_FRUSTUM_KIND", "symmetric", 1);
  const SceneConfig by_environment = read(text);
  const SceneConfig by_flag = read(text, {"radar.r_max_m=25000", "radar.r_max_m=30000"});
  unsetenv("OBLIQ_RADAR_R_MAX_M");
  unsetenv("OBLIQ_FRUSTUM_KIND");
  EXPECT_EQ(by_environment.radars[0].settings.r_max_m, 20000);
  EXPECT_EQ(by_environment.radars[0].settings.frustum, FrustumKind::symmetric);
  EXPECT_EQ(by_environment.radars[0].settings.r_min_m, 100);
  EXPECT_EQ(by_flag.radars[0].settings.r_max_m, 30000);  // the later flag wins
}

TEST_F(SceneFile, PolarisationHasTwoNames) {
  const auto polarisation = [&](const std::string& text, const std::vector<std::string>& flags = {}) {
    return read(std::string(kFlat) + text, flags).radars[0].settings.atmosphere.polarisation;
  };
  EXPECT_EQ(polarisation(""), Polarisation::horizontal);
  EXPECT_EQ(polarisation("[radar]\npolarisation = \"vertical\"\n"), Polarisation::vertical);
  EXPECT_EQ(polarisation("[atmosphere]\npolarisation = \"vertical\"\n"), Polarisation::vertical);
  EXPECT_EQ(polarisation("[atmosphere]\npolarisation = \"vertical\"\n[radar]\npolarisation = \"vertical\"\n"),
            Polarisation::vertical);
  // A flag beats the file, whichever name it has; so does a variable.
  const std::string file = "[atmosphere]\npolarisation = \"horizontal\"\n";
  EXPECT_EQ(polarisation(file, {"radar.polarisation=vertical"}), Polarisation::vertical);
  EXPECT_EQ(polarisation("[radar]\npolarisation = \"horizontal\"\n", {"atmosphere.polarisation=vertical"}),
            Polarisation::vertical);
  setenv("OBLIQ_RADAR_POLARISATION", "vertical", 1);
  EXPECT_EQ(polarisation(file), Polarisation::vertical);
  EXPECT_EQ(polarisation(file, {"atmosphere.polarisation=horizontal"}), Polarisation::horizontal);
  unsetenv("OBLIQ_RADAR_POLARISATION");
  const std::string both =
      "radar.polarisation: found \"vertical\" beside atmosphere.polarisation = "
      "\"horizontal\"; allowed: one of them";
  EXPECT_SAYS(complaint(std::string(kFlat) + file + "[radar]\npolarisation = \"vertical\"\n"), both);
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[radar]]\npolarisation = \"vertical\"\n[radar.atmosphere]\n"
                                             "polarisation = \"horizontal\"\n"),
              both);
  EXPECT_SAYS(
      complaint(std::string(kFlat), {"radar.polarisation=vertical", "atmosphere.polarisation=horizontal"}),
      "radar.polarisation: found vertical beside atmosphere.polarisation = horizontal; allowed: one of them");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[radar]\npolarisation = \"left\"\n"),
              "radar.polarisation: found \"left\"; allowed: \"horizontal\" | \"vertical\"");
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
  // A flag's path is the shell's: it counts from the working directory.
  EXPECT_EQ(read(text, {"terrain.dem=x.tif"}).world.terrain.dem,
            std::vector<std::string>{(std::filesystem::current_path() / "x.tif").string()});
}

TEST_F(SceneFile, AreaIsABoxOrAPolygon) {
  const auto area = [&](const std::string& value) {
    return read(kFlat + ("area = " + value)).world.terrain.area;
  };
  ASSERT_EQ(area("[-100, 32, -99, 33.5]").size(), 4u);
  EXPECT_EQ(area("[-100, 32, -99, 33.5]")[2].latitude_deg, 33.5);
  ASSERT_EQ(area("[[-100, 32], [-99, 32], [-99.5, 33]]").size(), 3u);
  // Across the antimeridian a box goes on eastward.
  const std::vector<LonLat> fiji = area("[179, -18, -179, -16]");
  ASSERT_EQ(fiji.size(), 4u);
  EXPECT_EQ(fiji[0].longitude_deg, 179);
  EXPECT_EQ(fiji[1].longitude_deg, 181);
  EXPECT_EQ(fiji[2].longitude_deg, 181);
  EXPECT_EQ(fiji[2].latitude_deg, -16);
  for (const std::string bad :
       {"[1, 2, 3]", "[-99, 32, -100, 33]", "[90, 0, -90, 1]", "[-100, 32, nan, 33]", "[-100, -95, -99, 33]",
        "[[1, 2], [3, 4]]", "[[0, 0], [1, 1], [2, 2]]", "[[0, 0], [1, 95], [2, 2]]", "\"all\"",
        "[[0, 0], [1, \"x\"], [2, 2]]", "[]", "7"})
    EXPECT_SAYS(complaint(kFlat + ("area = " + bad)), "FILE:3: terrain.area: found");
}

TEST_F(SceneFile, WidestVoidIsANumberOrAutomatic) {
  const auto fill_m = [&](const std::string& value) {
    return read(kFlat + ("fill_void_m = " + value)).world.terrain.fill_void_m;
  };
  EXPECT_FALSE(read(kFlat).world.terrain.fill_void_m);
  EXPECT_FALSE(fill_m("\"auto\""));
  EXPECT_EQ(fill_m("0"), 0.0);
  EXPECT_EQ(fill_m("450.5"), 450.5);
  for (const std::string bad : {"-1", "nan", "\"all\"", "[1]", "100001"})
    EXPECT_SAYS(complaint(kFlat + ("fill_void_m = " + bad)), "FILE:3: terrain.fill_void_m: found");
}

TEST_F(SceneFile, TheCacheIsAutomaticOffOrAFolder) {
  const auto folder = [&](const std::string& line) { return read(kFlat + line).world.terrain.cache_folder; };
  EXPECT_EQ(folder(""), usual_cache_folder());
  EXPECT_EQ(folder("cache = \"auto\""), usual_cache_folder());
  EXPECT_EQ(folder("cache = \"off\""), "");
  EXPECT_EQ(folder("cache = \"/var/grids\""), "/var/grids");
  EXPECT_EQ(folder("cache = \"grids\"").find('/'), 0u) << "from the scene file's folder";
  for (const std::string bad : {"true", "7", "\"\"", "[\"off\"]", "\"~/grids\""})
    EXPECT_SAYS(complaint(kFlat + ("cache = " + bad)), "FILE:3: terrain.cache: found");
}

TEST_F(SceneFile, SeaIsLookedForInElevationModelsUnlessItIsOff) {
  const auto material = [&](const std::string& text) { return read(text).world.terrain.water_material; };
  EXPECT_EQ(material("[terrain]\ndem = \"a.tif\"\narea = [1, 1, 2, 2]\n[antenna]\nlatitude_deg = "
                     "1\nlongitude_deg = 1\n"),
            3);
  EXPECT_FALSE(material(
      "[terrain]\ndem = \"a.tif\"\nsea = \"off\"\n[antenna]\nlatitude_deg = 1\nlongitude_deg = 1\n"));
  EXPECT_FALSE(material(kFlat));
  EXPECT_SAYS(complaint("[terrain]\nsynthetic = \"flat\"\nsea = \"dead\"\n"),
              "terrain.sea: found \"dead\"; allowed: \"auto\" or \"off\"");
}

TEST_F(SceneFile, LandCoverSchemesHaveAMaterialForEveryClassButIceAndSnow) {
  struct Legend {
    const char* scheme;
    std::size_t classes;  // of the published legend, without ice and snow
  };
  for (const Legend& legend : {Legend{"nlcd", 19}, Legend{"worldcover", 10}}) {
    const SceneConfig config = read(
        std::string(kFlat) + "[materials.aaa]\ngamma_db = -1\n[[surfaces]]\nsource = \"c.tif\"\nscheme = \"" +
        legend.scheme + "\"\n");
    EXPECT_EQ(config.world.surfaces.at(0).scheme_materials.size(), legend.classes);
    for (const auto& [value, material] : config.world.surfaces.at(0).scheme_materials) {
      const double db = to_db(config.materials.at(material).gamma);
      EXPECT_TRUE(db >= -40 && db <= 0) << value;
    }
  }
  EXPECT_SAYS(complaint(std::string(kFlat) + "[[surfaces]]\nsource = \"c.tif\"\nscheme = \"corine\"\n"),
              "surfaces.scheme: found \"corine\"; allowed: \"nlcd\" | \"worldcover\"");
  EXPECT_SAYS(complaint(std::string(kFlat) +
                        "[[surfaces]]\nsource = \"c.tif\"\nscheme = \"nlcd\"\nmaterial = \"water\"\n"),
              "nothing beside scheme");
}

TEST_F(SceneFile, GammaRastersStandAloneOrBesideASource) {
  const auto surface = [&](const std::string& keys) {
    return read(std::string(kFlat) + "[[surfaces]]\n" + keys).world.surfaces.at(0);
  };
  EXPECT_TRUE(surface("gamma_raster = 'x.tif'\n").gamma_raster.ends_with("/x.tif"));
  EXPECT_FALSE(surface("gamma_raster = 'x.tif'\n").raster_is_gamma);
  EXPECT_FALSE(surface("gamma_raster = 'x.tif'\n").paints);
  EXPECT_TRUE(surface("gamma_raster = 'x.tif'\ngamma_raster_is = 'gamma'\n").raster_is_gamma);
  EXPECT_TRUE(surface("gamma_raster = 'x.tif'\nmaterial = 'grass'\n").paints);
  EXPECT_TRUE(surface("source = 'a.shp'\nmaterial = 'grass'\ngamma_raster = 'x.tif'\n").paints);
  const auto refused = [&](const std::string& keys) {
    return complaint(std::string(kFlat) + "[[surfaces]]\n" + keys);
  };
  EXPECT_SAYS(refused("gamma_raster = 'x.tif'\ngamma_raster_is = 'linear'\n"),
              "surfaces.gamma_raster_is: found \"linear\"; allowed: \"offset\" | \"gamma\"");
  EXPECT_SAYS(refused("gamma_raster = 3\n"), "surfaces.gamma_raster: found 3; allowed: a path in quotes");
  EXPECT_SAYS(refused("source = 'a.shp'\nmaterial = 'grass'\ngamma_raster_is = 'gamma'\n"),
              "allowed: nothing without gamma_raster");
  EXPECT_SAYS(refused("gamma_raster = 'x.tif'\nclasses = [3]\n"),
              "surfaces.classes: found a list; allowed: nothing without source");
  EXPECT_SAYS(refused("source = 'a.shp'\ngamma_raster = 'x.tif'\n"), "surfaces.material: found nothing");
  EXPECT_SAYS(refused("material = 'grass'\n"), "surfaces.source: found nothing");
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
  EXPECT_DOUBLE_EQ(to_db(config.materials.at(0).gamma), -15.0);
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

}  // namespace
}  // namespace obliq::scene_file_test
