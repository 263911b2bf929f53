// Elevation models that adjoin: each ends at its own last posts, the ground goes on.
// Elevation models as they come from agencies. They are not part of the project: without them, skipped.
// Real outlines. They are not part of the project: without them, skipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include "tests/support/parts_check.h"
#include "tests/unit/terrain_files.h"
#include "tests/unit/terrain_outlines.h"

namespace obliq::seams_test {
namespace {

using test::Folder;
using test::RasterPlan;

constexpr double kLon = -99.5;
constexpr double kLat = 33;
constexpr double kPost_m = 30;
constexpr double kVoid = -9999;

// echo -99.5 33 | gdaltransform -s_srs EPSG:4269 -t_srs EPSG:26914
constexpr double kEast_m = 453291.840167944;
constexpr double kNorth_m = 3651397.94452688;

double plane(double x, double y) { return 100 + 0.1 * (x - kEast_m) + 0.05 * (y - kNorth_m); }

/// Posts of one lattice, point raster, void where the quad does not reach.
template <class Has>
RasterPlan quad(Has has) {
  RasterPlan plan;
  plan.crs = "EPSG:26914";
  plan.columns = plan.rows = 101;
  plan.geotransform = {kEast_m - 50.5 * kPost_m, kPost_m, 0, kNorth_m + 50.5 * kPost_m, 0, -kPost_m};
  plan.point = true;
  plan.nodata = kVoid;
  plan.value = [has](double x, double y) {
    const long column = std::lround((x - kEast_m) / kPost_m);
    const long row = std::lround((y - kNorth_m) / kPost_m);
    return has(column, row) ? plane(x, y) : kVoid;
  };
  return plan;
}

/// The quads' common edge leans: one posting sideways for every six.
long edge(long row) { return static_cast<long>(std::floor(static_cast<double>(row) / 6)); }

WorldSpec two_quads(const Folder& folder, bool feet = false) {
  const auto hole = [](long c, long r) { return std::abs(c - 20) <= 4 && std::abs(r) <= 4; };
  RasterPlan west = quad([](long c, long r) { return c <= edge(r); });
  RasterPlan east = quad([hole](long c, long r) { return c > edge(r) && !hole(c, r); });
  if (feet) {
    east.unit = "ft";
    east.value = [metres = east.value](double x, double y) {
      const double value = metres(x, y);
      return value == kVoid ? kVoid : value / 0.3048;
    };
  }
  WorldSpec spec = test::scene(
      kLon, kLat, 1000, {write_raster(folder, "west.tif", west), write_raster(folder, "east.tif", east)});
  spec.terrain.cell_m = 10;
  spec.terrain.fill_void_m = 0;
  return spec;
}

/// The same plane from one file that has all posts.
World whole(const Folder& folder) {
  WorldSpec spec = test::scene(kLon, kLat, 1000,
                               {write_raster(folder, "whole.tif", quad([](long, long) { return true; }))});
  spec.terrain.cell_m = 10;
  return load_world(spec);
}

TEST(Seams, QuadsWhoseLastPostsAreOnePostingApartGiveTheGroundOfOneFile) {
  const Folder folder;
  const World one = whole(folder);
  for (bool feet : {false, true}) {
    const World two = load_world(two_quads(folder, feet));
    ASSERT_EQ(two.grid.y_m.size(), one.grid.y_m.size());
    std::size_t unknown = 0;
    for (int j = 0; j < two.grid.nz; ++j) {
      for (int i = 0; i < two.grid.nx; ++i) {
        if (std::hypot(two.grid.node_x_m(i) - 600, two.grid.node_z_m(j)) < 260) continue;  // the hole
        if (!two.grid.node_known(i, j)) {
          ++unknown;
          continue;
        }
        // Posts and heights are float32: 8 micrometres each at 100 m; feet round a second time.
        ASSERT_NEAR(two.grid.node_y_m(i, j), one.grid.node_y_m(i, j), 1e-3) << i << " " << j;
      }
    }
    EXPECT_EQ(unknown, 0u);
  }
}

TEST(Seams, GroundThatNoFileHasIsNotMadeUpBeyondHalfAPosting) {
  const Folder folder;
  const World world = load_world(two_quads(folder));
  // Nine void posts by nine: 300 m between known posts, of which a rim of 15 m is theirs. Convergence turns
  // the posts by 0.3 degrees, so that places are good to some metres.
  EXPECT_TRUE(std::isnan(world.grid.height_at_m(600, 0)));
  EXPECT_TRUE(std::isnan(world.grid.height_at_m(600 - 120, 0)));
  EXPECT_FALSE(std::isnan(world.grid.height_at_m(600 - 165, 0)));
  const double side_m = 300 - 2 * 15;
  const double void_m2 = static_cast<double>(world.report.posts_absent) * 10 * 10;
  EXPECT_NEAR(void_m2, side_m * side_m, 2 * 4 * side_m * 10 / 2);  // half a cell on every side
}

TEST(Seams, OneFileIsNotWidened) {
  const Folder folder;
  WorldSpec spec = two_quads(folder);
  spec.terrain.dem.resize(1);
  const World world = load_world(spec);
  // Its last posts around the origin stand at x = 0.
  const int i = static_cast<int>(-world.grid.x0_m / 10);
  const int j = static_cast<int>(-world.grid.z0_m / 10);
  EXPECT_TRUE(world.grid.node_known(i - 1, j + 1));
  EXPECT_FALSE(world.grid.node_known(i + 1, j + 1));
}

TEST(Voids, OneMissingPostIsFilledHoweverCoarseTheModel) {
  const Folder folder;
  for (const double post_m : {30.0, 300.0}) {
    RasterPlan plan = quad([](long, long) { return true; });
    plan.geotransform = {kEast_m - 50.3 * post_m, post_m, 0, kNorth_m + 50.2 * post_m, 0, -post_m};
    plan.value = [post_m](double x, double y) {
      return std::hypot(x - kEast_m, y - kNorth_m) < 0.6 * post_m ? kVoid : plane(x, y);
    };
    WorldSpec spec = test::scene(kLon, kLat, 20 * post_m, {write_raster(folder, "hole.tif", plan)});
    const World world = load_world(spec);
    EXPECT_EQ(world.report.posts_absent, 0u) << post_m;
    EXPECT_GE(world.report.posts_filled, 1u) << post_m;
    spec.terrain.fill_void_m = 0;
    EXPECT_GE(load_world(spec).report.posts_absent, 1u) << post_m;
  }
}

TEST(Seams, TheTwoQuadsOfSanFranciscoHaveNoCrackBetweenThem) {
  const std::string south = test::shared_file("sf_city/sanfranciscos.dem");
  const std::string north = test::shared_file("sf_city/San_Fran_North.dem");
  if (south.empty() || north.empty()) {
    GTEST_SKIP() << test::no_shared_file("sf_city/sanfranciscos.dem");
  }
  // The seam is the parallel 37.75 N of NAD27. One post of it is in neither file: its nodes are a void like
  // any other and filled.
  WorldSpec spec = test::scene(-122.44, 37.75, 3000, {south, north});
  spec.terrain.cell_m = 10;
  for (int turn = 0; turn < 2; ++turn) {
    const World world = load_world(spec);
    EXPECT_EQ(world.report.posts_absent, 0u);
    EXPECT_LE(world.report.posts_filled, 9u);  // three nodes by three around a post of 30 m
    std::swap(spec.terrain.dem[0], spec.terrain.dem[1]);
  }
}

struct RealFile {
  const char* name;
  double lowest_m, highest_m;  // of the whole file, by gdalinfo
  const char* crs = "";
  VerticalUnit unit = VerticalUnit::metre;
  bool override_unit = false;
};

/// What a listing of the tests shows of the parameter.
void PrintTo(const RealFile& value, std::ostream* out) { *out << value.name; }

class RealDem : public testing::TestWithParam<RealFile> {};

TEST_P(RealDem, LoadsWholeWithHeightsInItsRange) {
  const RealFile& real = GetParam();
  const std::string dem = test::shared_file(real.name);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(real.name);
  WorldSpec spec = test::scene(0, 0, 1, {dem});
  if (*real.crs) spec.terrain.crs = real.crs;
  if (real.override_unit) spec.terrain.unit = real.unit;
  spec.origin = dem_centre(spec.terrain);
  spec.reaches.clear();
  const World world = load_world(spec);
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (float y : world.grid.y_m) {
    if (std::isnan(y)) continue;
    low = std::min(low, static_cast<double>(y));
    high = std::max(high, static_cast<double>(y));
  }
  // Interpolated between posts: inside the range, and most of the way to its ends.
  EXPECT_GE(low, real.lowest_m - 0.01);
  EXPECT_LE(high, real.highest_m + 0.01);
  EXPECT_GT(high - low, 0.85 * (real.highest_m - real.lowest_m));
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealDem,
    testing::Values(RealFile{"nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif", 1834.2, 2278.6},
                    RealFile{"fortworth_tx_90m/dem.tif", 147, 298},
                    RealFile{"houston_tx_3dep_10m/dem_tx_10m.tif", 0, 22.5},
                    RealFile{"sf_city/sf_3dep_resampled_30m_utm10n.tif", -5.6, 282.8},
                    RealFile{"sf_city/San_Fran_North.dem", 0, 343},
                    RealFile{"sf_city/sanfranciscos.dem", 0, 1314 * 0.3048},  // tagged in feet
                    RealFile{"az_utm_vertfeet/dem.tif", 4029 * 0.3048, 6458 * 0.3048, "", VerticalUnit::foot,
                             true},
                    RealFile{"nh_gridfloat_ned/PresRange_1as.flt", 415.7, 1916.5},
                    RealFile{"small/sagehen_dem10m.img", 1920.4, 2663.3},
                    RealFile{"small/faultzone.tif", 631.6, 700, "EPSG:32611"},
                    RealFile{"small/hugo_site.asc", 1660, 1711, "EPSG:26913"},
                    RealFile{"small/osmnx_elevation2.tif", -35, 118},
                    RealFile{"small/elevation_pkg_GLO-90_nw_san_francisco.tif", -6.2, 198.5},
                    RealFile{"small/elevation_pkg_SRTM3_nw_san_francisco.tif", -16, 193},
                    RealFile{"windninja_usfs/mackay.tif", 1732.5, 3645.4},
                    RealFile{"windninja_usfs/some_nodata.tif", 1733.1, 3602.9}),
    [](const testing::TestParamInfo<RealFile>& given) {
      std::string name = given.param.name;
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
      return name;
    });

struct City {
  const char* name;
  const char* dem;
  const char* outlines;
  const char* height_field;
  double longitude_deg, latitude_deg, reach_m;
  std::uint64_t features;
  double least_kept;
};

/// What a listing of the tests shows of the parameter.
void PrintTo(const City& value, std::ostream* out) { *out << value.name; }

class RealCity : public testing::TestWithParam<City> {};

TEST_P(RealCity, EveryPrismIsAClosedSolidOfItsFootprintAndHeight) {
  const City& city = GetParam();
  const std::string dem = test::shared_file(city.dem);
  const std::string outlines = test::shared_file(city.outlines);
  if (dem.empty() || outlines.empty()) {
    GTEST_SKIP() << test::no_shared_file(city.outlines);
  }
  WorldSpec spec = test::scene(city.longitude_deg, city.latitude_deg, city.reach_m, {dem});
  spec.radius_factor = 4.0 / 3;
  spec.buildings.emplace_back();
  spec.buildings[0].source = outlines;
  spec.buildings[0].height_field = city.height_field;
  const World world = load_world(spec);
  const LoadReport& r = world.report;
  std::printf(
      "%s: read %lu kept %lu repaired %lu zero %lu duplicate %lu outside %lu no ground %lu unusable %lu\n",
      city.name, r.buildings_read, r.buildings_kept, r.buildings_repaired, r.buildings_zero_area,
      r.buildings_duplicate, r.buildings_outside, r.buildings_no_ground, r.buildings_unusable);
  EXPECT_EQ(r.buildings_read, city.features);
  EXPECT_GT(static_cast<double>(r.buildings_kept), city.least_kept * static_cast<double>(city.features));
  for (std::size_t k = 0; k < world.buildings.list.size(); ++k) {
    const Building& building = world.buildings.list[k];
    const double area = test::roof_area_m2(world.buildings, k);
    const double height = static_cast<double>(building.roof_y_m) - static_cast<double>(building.base_y_m);
    ASSERT_GT(area, 0);
    ASSERT_GT(height, 0);
    ASSERT_NEAR(test::enclosed_volume_m3(world.buildings, k), area * height, 1e-6 * area * height) << k;
    test::expect_parts_make_up(world.buildings, static_cast<std::uint32_t>(k),
                               "building " + std::to_string(k));
  }
  std::printf("%zu buildings are cut into %zu convex parts\n",
              static_cast<std::size_t>(std::ranges::count_if(
                  world.buildings.list, [](const Building& b) { return b.n_parts > 0; })),
              world.buildings.parts.size());
}

INSTANTIATE_TEST_SUITE_P(Cities, RealCity,
                         testing::Values(City{"SanFrancisco", "sf_city/sf_3dep_resampled_30m_utm10n.tif",
                                              "sf_city/sf_buildings_heights_from_mvt.geojson", "height",
                                              -122.435, 37.77, 12000, 13896, 0.95},
                                         City{"LosAngeles", "la_nasadem_30m/NASADEM_HGT_n34w119.tif",
                                              "la_city/la_buildings_in_nasadem_tile_metres.geojson",
                                              "height_m", -118.45, 34.05, 46250, 5434, 0.9}),
                         [](const testing::TestParamInfo<City>& given) {
                           return std::string(given.param.name);
                         });

}  // namespace
}  // namespace obliq::seams_test
