// Water that an elevation model itself shows (terrain.sea). Areas follow from the shapes drawn.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "terrain/base/parallel.h"
#include "tests/unit/terrain_outlines.h"

namespace obliq::water_cells_test {
namespace {

using test::Folder;

constexpr std::uint8_t kWater = 3;
constexpr double kEast_m = 93453;    ///< a degree of longitude at 33 degrees north
constexpr double kNorth_m = 110910;  ///< a degree of latitude

using Height = std::function<double(double x_m, double z_m)>;

/// A tile of pixels of 1/1200 degree, about 78 x 92 m, whose west and south edges lie there; heights in
/// metres over the scene's origin.
test::RasterPlan tile(double west_deg, double south_deg, int columns, int rows, const Height& height_m) {
  test::RasterPlan plan;
  plan.columns = columns;
  plan.rows = rows;
  plan.geotransform = {west_deg, 1.0 / 1200, 0, south_deg + rows / 1200.0, 0, -1.0 / 1200};
  plan.value = [height_m](double lon, double lat) {
    return height_m((lon + 99.5) * kEast_m, (lat - 33) * kNorth_m);
  };
  return plan;
}

test::RasterPlan tile(const Height& height_m) { return tile(-99.56, 32.94, 144, 144, height_m); }

WorldSpec looking_for_water(std::vector<std::string> dem, double reach_m = 4000) {
  WorldSpec spec = test::scene(-99.5, 33, reach_m, std::move(dem));
  spec.terrain.cell_m = 50;
  spec.terrain.water_material = kWater;
  return spec;
}

World loaded(const test::RasterPlan& plan, double reach_m = 4000) {
  const Folder folder;
  return load_world(looking_for_water({test::write_raster(folder, "tile.tif", plan)}, reach_m));
}

int at(const World& world, double x_m, double z_m) {
  return world.material_of_cell(static_cast<int>(std::floor((x_m - world.grid.x0_m) / world.grid.cell_m)),
                                static_cast<int>(std::floor((z_m - world.grid.z0_m) / world.grid.cell_m)));
}

double slope(double x_m, double z_m) { return 300 + 0.0173 * x_m + 0.0071 * z_m; }

/// Slopes with a level lake of 1,000 m radius and a pond of 400 m.
double lake(double x_m, double z_m) {
  if (std::hypot(x_m, z_m) < 1000) return 123.4;
  if (std::hypot(x_m - 2500, z_m) < 400) return 123.4;
  return slope(x_m, z_m);
}

/// Sea in the west, land that rises from 5 m in the east, with a basin at 0 m of 600 m radius.
double coast(double x_m, double z_m) {
  if (x_m < -1000 || std::hypot(x_m - 1500, z_m) < 600) return 0;
  return 5 + std::floor((x_m + 1000) / 100);
}

TEST(Water, LevelLakeOfASquareKilometreIsWaterAndAPondIsNot) {
  const World world = loaded(tile(lake));
  EXPECT_EQ(at(world, 0, 0), kWater);
  EXPECT_EQ(at(world, 700, 600), kWater);
  EXPECT_EQ(at(world, 2500, 0), 0) << "0.5 km2";
  EXPECT_EQ(at(world, -2000, 0), 0);
  EXPECT_NEAR(world.report.water_m2, std::numbers::pi * 1e6, 0.1e6);  // cells along the shore
}

TEST(Water, LevelPlainInWholeMetresIsLandAlsoInAFileOfFloats) {
  for (const char* type : {"Int16", "Float32"}) {
    test::RasterPlan plan = tile([](double x_m, double) { return 100 + std::floor(std::abs(x_m) / 3000); });
    plan.type = type;
    const World world = loaded(plan);
    EXPECT_EQ(world.report.water_m2, 0) << type;
    EXPECT_TRUE(world.surface_material.empty());
  }
}

// As USGS models made from whole metres and moved to another datum have them (mackay.tif: 1772.259,
// 1773.259).
TEST(Water, TerracesOfWholeMetresAreLandWhateverTheFractionThatAllShare) {
  const auto terraces = [](double x_m, double z_m) {
    return std::hypot(x_m, z_m) < 1000 ? 1799.737 : 1760.259 + std::floor(std::abs(x_m + 5e3) / 2000);
  };
  const World world = loaded(tile(terraces));
  EXPECT_EQ(at(world, 0, 0), kWater) << "a lake between them";
  EXPECT_NEAR(world.report.water_m2, std::numbers::pi * 1e6, 0.1e6);
}

TEST(Water, SeaThatReachesTheEdgeOfTheModelIsWaterAndABasinInlandIsNot) {
  test::RasterPlan plan = tile(coast);
  plan.type = "Int16";
  const World world = loaded(plan, 8000);
  EXPECT_EQ(at(world, -2000, 1000), kWater);
  EXPECT_EQ(at(world, -1200, 0), kWater);
  EXPECT_EQ(at(world, -800, 0), 0);
  EXPECT_EQ(at(world, 1500, 0), 0) << "1.1 km2, and no way to the sea";
}

TEST(Water, SeaGrowsOverLevelShoalsUpToOneMetreAndNoFurther) {
  // It rises by 0.3 m a kilometre, from below -1 m in the west to above 0 m, then by 1.6 m in one step.
  const auto shoal = [](double x_m, double z_m) {
    return 3e-5 * z_m + (x_m < 1000 ? -0.2 + 3e-4 * x_m : 1.7 + 1e-3 * x_m);
  };
  const World world = loaded(tile(shoal), 8000);
  EXPECT_EQ(at(world, -3000, 0), kWater);
  EXPECT_EQ(at(world, 800, 0), kWater);
  EXPECT_EQ(at(world, 1300, 0), 0);
  // A polder below the sea, behind a dyke: nothing in it lies between -1 and 0 m.
  const auto polder = [](double x_m, double z_m) {
    return std::hypot(x_m, z_m) < 1900 ? -2.0 + 1e-5 * x_m : 20 + 1e-3 * x_m + 3e-4 * z_m;
  };
  EXPECT_EQ(loaded(tile(polder), 8000).report.water_m2, 0);
}

TEST(Water, BayThatAWindowCutsCountsWithWhatLiesInIt) {
  // 3,600 x 3,600 m of water in the middle of the model: 13 km2.
  const auto bay = [](double x_m, double z_m) {
    return std::max(std::abs(x_m), std::abs(z_m)) < 1800 ? -0.5 + 1e-5 * x_m : 20 + 1e-3 * x_m;
  };
  EXPECT_NEAR(loaded(tile(bay), 4000).report.water_m2, 12.96e6, 0.6e6);
  EXPECT_EQ(loaded(tile(bay), 1000).report.water_m2, 0) << "4 km2 and a few posts beside them";
}

TEST(Water, TwoTilesOfOneSeaHaveNoStripOfLandBetweenThem) {
  const Folder folder;
  const auto sea = [](double, double z_m) { return z_m < 2000 ? -0.25 + 1e-5 * z_m : 30 + 1e-3 * z_m; };
  for (const double cell_m : {50.0, 10.0}) {
    WorldSpec spec =
        looking_for_water({test::write_raster(folder, "west.tif", tile(-99.56, 32.94, 72, 144, sea)),
                           test::write_raster(folder, "east.tif", tile(-99.5, 32.94, 72, 144, sea))},
                          2000);
    spec.terrain.cell_m = cell_m;
    const World world = load_world(spec);
    for (double x_m = -400; x_m < 400; x_m += cell_m)
      ASSERT_EQ(at(world, x_m + 1, 0), kWater) << x_m << ' ' << cell_m;
  }
}

TEST(Water, NamedSurfacesWin) {
  const Folder folder;
  WorldSpec spec = looking_for_water({test::write_raster(folder, "tile.tif", tile(lake))});
  SurfaceSpec island;
  island.source = folder.text(
      "island.geojson",
      test::collection({test::polygon_feature(test::town_frame(), {test::square(-200, -200, 400)})}));
  island.material = 5;
  spec.surfaces = {island};
  const World world = load_world(spec);
  EXPECT_EQ(at(world, 0, 0), 5);
  EXPECT_EQ(at(world, 500, 0), kWater);
}

TEST(Water, IsLookedForOnlyWhereItIsAskedFor) {
  const Folder folder;
  WorldSpec spec = looking_for_water({test::write_raster(folder, "tile.tif", tile(lake))});
  spec.terrain.water_material.reset();
  EXPECT_TRUE(load_world(spec).surface_material.empty());
}

TEST(Water, IsTheSameFromTheCacheAndOnOneThread) {
  const Folder folder;
  WorldSpec spec = looking_for_water({test::write_raster(folder, "tile.tif", tile(lake))});
  const World plain = load_world(spec);
  World alone;
  on_this_thread_alone([&] { alone = load_world(spec); });
  EXPECT_EQ(plain.surface_material, alone.surface_material);
  spec.terrain.cache_folder = folder.file("cache");
  EXPECT_EQ(load_world(spec).surface_material, plain.surface_material);
  // Files of this very second are not kept, as they may still be written.
  std::filesystem::last_write_time(spec.terrain.dem[0],
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  for (int k = 0; k < 2; ++k) {
    const World cached = load_world(spec);
    EXPECT_EQ(cached.surface_material, plain.surface_material) << k;
    EXPECT_EQ(cached.report.water_m2, plain.report.water_m2) << k;
  }
}

struct Place {
  const char* file;
  double least_km2, most_km2;
};

TEST(Water, RealCoastsHaveTheirSeaAndAFlatCityHasNone) {
  // The Pacific and the bay in the tile of San Francisco: 102 of its 237 km2 are at or below 0 m, some of it
  // deeper than tides; Los Angeles' tile has 174 km2 of posts at exactly 0 m; Houston's lowest lie at 0.04 m.
  const Place places[] = {{"sf_city/sf_3dep_resampled_30m_utm10n.tif", 85, 110},
                          {"la_nasadem_30m/NASADEM_HGT_n34w119.tif", 150, 185},
                          {"houston_tx_3dep_10m/dem_tx_10m.tif", 0, 0}};
  for (const Place& place : places) {
    const std::string dem = test::shared_file(place.file);
    if (dem.empty()) GTEST_SKIP() << test::no_shared_file(place.file);
    WorldSpec spec = looking_for_water({dem});
    spec.terrain.cell_m = 60;
    spec.origin = dem_centre(spec.terrain);
    spec.reaches.clear();
    const double km2 = load_world(spec).report.water_m2 / 1e6;
    EXPECT_GE(km2, place.least_km2) << place.file;
    EXPECT_LE(km2, place.most_km2) << place.file;
  }
}

}  // namespace
}  // namespace obliq::water_cells_test
