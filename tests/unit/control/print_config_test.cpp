// What --print-config prints is a scene file that means the same.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <random>

#include "server/control/parameters.h"
#include "server/control/scene_file.h"
#include "server/control/sections/materials.h"
#include "server/control/sections/section.h"
#include "server/control/sections/sources.h"

namespace obliq::print_config_test {
namespace {

std::filesystem::path write(const std::string& text, const std::string& folder) {
  const auto path =
      std::filesystem::path(testing::TempDir()) / ("obliq_print_" + std::to_string(getpid()) + folder);
  std::filesystem::create_directories(path);
  std::ofstream(path / "scene.toml", std::ios::binary) << text;
  return path / "scene.toml";
}

template <class T>
void expect_same(std::span<const Row<T>> rows, T a, T b) {
  for (const auto& [key, slot, change] : rows) EXPECT_EQ(load(key, slot(a)), load(key, slot(b))) << key.name;
}

bool same_place(const LonLat& a, const LonLat& b) {
  return a.longitude_deg == b.longitude_deg && a.latitude_deg == b.latitude_deg;
}

void expect_same(const SceneConfig& a, const SceneConfig& b) {
  expect_same(scene_rows(), a, b);
  const TerrainSpec& s = a.world.terrain;
  const TerrainSpec& t = b.world.terrain;
  EXPECT_EQ(s.dem, t.dem);
  EXPECT_EQ(s.unit, t.unit);
  EXPECT_EQ(s.crs, t.crs);
  EXPECT_EQ(s.water_material, t.water_material);
  EXPECT_TRUE(std::ranges::equal(s.area, t.area, same_place));
  ASSERT_EQ(a.world.buildings.size(), b.world.buildings.size());
  for (std::size_t i = 0; i < a.world.buildings.size(); ++i) {
    expect_same(kBuildings.keys.rows, a.world.buildings[i], b.world.buildings[i]);
    EXPECT_EQ(a.world.buildings[i].source, b.world.buildings[i].source);
    EXPECT_EQ(a.world.buildings[i].unit, b.world.buildings[i].unit);
    EXPECT_EQ(a.world.buildings[i].material, b.world.buildings[i].material);
  }
  ASSERT_EQ(a.world.prisms.size(), b.world.prisms.size());
  for (std::size_t i = 0; i < a.world.prisms.size(); ++i) {
    const PrismSpec& p = a.world.prisms[i];
    const PrismSpec& q = b.world.prisms[i];
    expect_same(kPrisms.keys.rows, p, q);
    EXPECT_EQ(p.within, q.within);
    EXPECT_TRUE(std::ranges::equal(p.within_polygon, q.within_polygon, same_place));
    EXPECT_EQ(p.width_m, q.width_m);
    EXPECT_EQ(p.length_m, q.length_m);
    EXPECT_EQ(p.height_m, q.height_m);
    EXPECT_EQ(p.material, q.material);
  }
  ASSERT_EQ(a.world.surfaces.size(), b.world.surfaces.size());
  for (std::size_t i = 0; i < a.world.surfaces.size(); ++i) {
    EXPECT_EQ(a.world.surfaces[i].source, b.world.surfaces[i].source);
    EXPECT_EQ(a.world.surfaces[i].layer, b.world.surfaces[i].layer);
    EXPECT_EQ(a.world.surfaces[i].where, b.world.surfaces[i].where);
    EXPECT_EQ(a.world.surfaces[i].classes, b.world.surfaces[i].classes);
    EXPECT_EQ(a.world.surfaces[i].material, b.world.surfaces[i].material);
    EXPECT_EQ(a.world.surfaces[i].scheme_materials, b.world.surfaces[i].scheme_materials);
    EXPECT_EQ(a.world.surfaces[i].gamma_raster, b.world.surfaces[i].gamma_raster);
    EXPECT_EQ(a.world.surfaces[i].raster_is_gamma, b.world.surfaces[i].raster_is_gamma);
    EXPECT_EQ(a.world.surfaces[i].paints, b.world.surfaces[i].paints);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_EQ(a.materials[i].name, b.materials[i].name);
    EXPECT_EQ(a.materials[i].gamma, b.materials[i].gamma) << a.materials[i].name;
    expect_same(material_rows(), MaterialKeys{a.materials[i], 0}, MaterialKeys{b.materials[i], 0});
  }
  ASSERT_EQ(a.radars.size(), b.radars.size());
  for (std::size_t i = 0; i < a.radars.size(); ++i) {
    EXPECT_EQ(a.radars[i].name, b.radars[i].name);
    for (const Parameter& p : parameters())
      EXPECT_EQ(value_of(p, a.radars[i]), value_of(p, b.radars[i])) << p.key.name;
  }
}

TEST(PrintConfig, ASceneWithEverythingReadsBackTheSameFromAnotherFolder) {
  const SceneConfig config = load_scene_file(write(R"(
[terrain]
dem = ["a \"quoted\" name.tif", "/data/b.tif"]
unit = "us_ft"
crs = "EPSG:26911"
area = [-100.125, 32.1, -99.3, 33.7]
cell_m = 12.5
sea = "off"
fill_void_m = 90
cache = "grids"
[earth]
radius_factor = 1.2
[[buildings]]
source = "houses.gpkg"
layer = "roofs"
unit = "ft"
material = "urban"
[[prisms]]
within = [[-100, 32], [-99, 32], [-99.5, 33.1]]
width_m = 7
height_m = [3, 4.5]
[[prisms]]
within = "towns.geojson"
seed = 18446
[[surfaces]]
source = "cover.tif"
classes = [11, -12]
material = "odd name é"
[[surfaces]]
source = "nlcd.tif"
scheme = "nlcd"
[[surfaces]]
source = "lakes.shp"
where = "kind = 'lake'"
material = "water"
gamma_raster = "lakes.tif"
[[surfaces]]
gamma_raster = "/data/fields.tif"
gamma_raster_is = "gamma"
[[surfaces]]
gamma_raster = "roads.tif"
material = "barren"
[materials."odd name é"]
model = "flat_plate"
gamma_db = -17.3
plate_tau = 0.3
[materials.building]
rms_slope = 0.07
[antenna]
latitude_deg = 32.987654321
longitude_deg = -99.123456789
[[radar]]
name = "one"
frustum = { kind = "oblique" }
[[radar]]
name = "two"
frequency_ghz = 0.435
antenna.height_reference = "ground"
frustum = { kind = "symmetric", pixels = [100, 200] }
[run]
threads = 2
[server]
port = 9999
handshake_timeout_s = 0.1
)",
                                                   "_a"));
  const std::string printed = print_config(config);
  const SceneConfig again = load_scene_file(write(printed, "_b"));
  expect_same(config, again);
  EXPECT_EQ(print_config(again), printed);
  EXPECT_EQ(again.world.terrain.cache_folder, config.world.terrain.cache_folder);
}

TEST(PrintConfig, AnAreaAcrossTheAntimeridianReadsBackTheSame) {
  const SceneConfig config =
      load_scene_file(write("[terrain]\nsynthetic = \"hills\"\narea = [179.5, -18, -179.5, -17]\n", "_m"));
  const std::string printed = print_config(config);
  const SceneConfig again = load_scene_file(write(printed, "_n"));
  expect_same(config, again);
  ASSERT_EQ(again.world.terrain.area.size(), 4u);
  EXPECT_EQ(again.world.terrain.area[1].longitude_deg, 180.5);
}

TEST(PrintConfig, DefaultsReadBackTheSame) {
  const SceneConfig config = load_scene_file(write("[terrain]\nsynthetic = \"hills\"\n", "_d"));
  const std::string printed = print_config(config);
  expect_same(config, load_scene_file(write(printed, "_e")));
  EXPECT_NE(printed.find("radius_factor = inf"), std::string::npos);
  EXPECT_NE(printed.find("fill_void_m = \"auto\""), std::string::npos);
  EXPECT_NE(printed.find("[integer 1 to 16384; live]"), std::string::npos);
}

TEST(PrintConfig, AwkwardNumbersReadBackToTheSameBits) {
  std::mt19937_64 random(7);
  SceneConfig config = load_scene_file(write("[terrain]\nsynthetic = \"flat\"\n", "_f"));
  for (int trial = 0; trial < 50; ++trial) {
    for (const Parameter& p : parameters()) {
      const Slot slot = p.slot(config.radars[0]);
      if (double* const* number = std::get_if<double*>(&slot)) {
        const double u = static_cast<double>(random() >> 11) * 0x1p-53;
        **number = p.key.limits.low + u * (p.key.limits.high - p.key.limits.low);
      }
    }
    config.radars[0].settings.r_min_m = config.radars[0].settings.r_max_m * 1e-7;
    config.radars[0].settings.speckle_seed = static_cast<std::int64_t>(random());
    if (!validate(config.radars[0]).empty()) continue;
    expect_same(config, load_scene_file(write(print_config(config), "_g")));
  }
}

TEST(Decibels, PrintedRatiosReadBackToTheSameBits) {
  for (int tenths = -2000; tenths <= 600; ++tenths) {
    const double db = tenths / 10.0;
    EXPECT_EQ(from_db(to_db(from_db(db))), from_db(db)) << db;
  }
  EXPECT_EQ(to_db(1.0), 0.0);
  EXPECT_EQ(to_db(from_db(-15)), -15.0);
}

TEST(Materials, ShippedOnesHaveTheirFixedPlaces) {
  const auto materials = shipped_materials();
  const std::vector<std::string> names{"terrain", "building", "ground", "water", "urban", "forest",
                                       "suburb",  "shrubs",   "grass",  "marsh", "barren"};
  ASSERT_EQ(materials.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(materials[i].name, names[i]);
  EXPECT_DOUBLE_EQ(10 * std::log10(materials[0].gamma), -15);  // farmland, Nathanson 1999
  EXPECT_EQ(materials[1].model, ScatteringModel::geometric_optics);
  EXPECT_EQ(materials[1].reflectivity, 0.5);
  EXPECT_EQ(materials[1].rms_slope, 0.1);
  EXPECT_DOUBLE_EQ(materials[3].gamma, 1e-4);  // sea state 3, Long 2001
}

}  // namespace
}  // namespace obliq::print_config_test
