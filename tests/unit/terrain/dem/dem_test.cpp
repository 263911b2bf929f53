#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "terrain/dem/source_extents.h"
#include "tests/unit/terrain_files.h"

namespace obliq::test::dem_test {
namespace {

using test::around;
using test::Folder;
using test::ground_at;
using test::RasterPlan;
using test::scene;
using test::write_raster;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLon = -99.5;
constexpr double kLat = 33;

/// A plane in longitude and latitude: what bilinear posts reproduce exactly, 100 m at the centre.
double plane(double lon, double lat) { return 100 + 5000 * (lon - kLon) - 3000 * (lat - kLat); }

/// Heights are float32 (8 micrometres at 100 m), cells of 25 m bend 0.01 mm over a plane in degrees, and the
/// solved height settles to under a millimetre.
constexpr double kPlaneTolerance_m = 2e-3;

void expect_plane(const World& world, double factor = 1) {
  for (double de : {-0.011, 0.0, 0.0073}) {
    for (double dn : {-0.009, 0.0, 0.0111}) {
      const double h = factor * plane(kLon + de, kLat + dn);
      EXPECT_NEAR(ground_at(world, kLon + de, kLat + dn, h), h, kPlaneTolerance_m) << de << " " << dn;
    }
  }
}

WorldSpec plane_scene(const std::string& dem) {
  WorldSpec spec = scene(kLon, kLat, 1500, {dem});
  spec.terrain.cell_m = 25;
  return spec;
}

TEST(Dem, HeightsAreAtTheirLongitudeAndLatitude) {
  const Folder folder;
  const World world = load_world(plane_scene(write_raster(folder, "a.tif", around(kLon, kLat, plane))));
  expect_plane(world);
  EXPECT_EQ(world.report.posts_absent, 0u);
  EXPECT_EQ(world.grid.nx, 121);
}

TEST(Dem, PostsAreAtPixelCentresWhetherPixelsAreAreasOrPoints) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, plane);
  plan.point = true;
  expect_plane(load_world(plane_scene(write_raster(folder, "p.tif", plan))));
}

TEST(Dem, SouthUpAndRotatedRastersLieWhereTheirGeotransformSays) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, plane);
  plan.geotransform[3] = kLat - 30.5 / 1200;
  plan.geotransform[5] = 1.0 / 1200;
  expect_plane(load_world(plane_scene(write_raster(folder, "south.tif", plan))));
  const double a = 0.5, s = std::sin(a) / 1200, c = std::cos(a) / 1200;
  plan.geotransform = {kLon - 30.5 * (c + s), c, s, kLat - 30.5 * (s - c), s, -c};
  expect_plane(load_world(plane_scene(write_raster(folder, "turned.tif", plan))));
}

TEST(Dem, ProjectedRastersInMetresAndFeetLieAtTheirPlace) {
  const Folder folder;
  // The value is a plane in the file's own coordinates, 100 m at the origin's, which another program gave:
  // echo -99.5 33 | gdaltransform -s_srs EPSG:4269 -t_srs EPSG:26914 (UTM zone 14N) or EPSG:2276 (Texas North
  // Central in US survey feet).
  struct Case {
    const char* crs;
    double x, y, pixel;
  };
  for (const Case& k : {Case{"EPSG:26914", 453291.840167944, 3651397.94452688, 30},
                        Case{"EPSG:2276", 1661939.13823643, 7048206.46562203, 100}}) {
    RasterPlan plan;
    plan.crs = k.crs;
    plan.columns = plan.rows = 201;
    plan.geotransform = {k.x - 100.5 * k.pixel, k.pixel, 0, k.y + 100.5 * k.pixel, 0, -k.pixel};
    plan.value = [&](double x, double y) { return 100 + 0.1 * (x - k.x) + 0.05 * (y - k.y); };
    WorldSpec spec = plane_scene(write_raster(folder, "projected.tif", plan));
    const World world = load_world(spec);
    EXPECT_NEAR(world.grid.height_at_m(0, 0), 100, 1e-3) << k.crs;  // 1 cm of place on a slope of 0.1
    // Slope across one kilometre east, in the file's units per metre, says that its unit was understood.
    const double unit = std::string(k.crs) == "EPSG:2276" ? 3937.0 / 1200 : 1.0;
    const double rise = world.grid.height_at_m(500, 0) - world.grid.height_at_m(-500, 0);
    EXPECT_NEAR(rise, 100 * unit, 3 * unit) << k.crs;  // convergence turns axes by up to a degree
  }
}

TEST(Dem, Nad83IsTakenAsWgs84) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, plane);
  plan.crs = "EPSG:4269";
  expect_plane(load_world(plane_scene(write_raster(folder, "nad83.tif", plan))));
}

TEST(Dem, FeetAreReadFromTheBandAndTheSceneFileOverridesIt) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, plane);
  plan.unit = "ft";
  const std::string feet = write_raster(folder, "feet.tif", plan);
  expect_plane(load_world(plane_scene(feet)), 0.3048);
  plan.unit = "US survey foot";
  expect_plane(load_world(plane_scene(write_raster(folder, "us.tif", plan))), 1200.0 / 3937);
  WorldSpec spec = plane_scene(feet);
  spec.terrain.unit = VerticalUnit::metre;
  expect_plane(load_world(spec), 1);
  plan.unit = "";
  spec = plane_scene(write_raster(folder, "silent.tif", plan));
  expect_plane(load_world(spec), 1);
  spec.terrain.unit = VerticalUnit::foot;
  expect_plane(load_world(spec), 0.3048);
}

TEST(Dem, FeetOfACompoundCoordinateSystemAreRead) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, plane);
  plan.crs = "EPSG:4269+6360";  // NAD83 and NAVD88 in US survey feet
  expect_plane(load_world(plane_scene(write_raster(folder, "compound.tif", plan))), 1200.0 / 3937);
}

TEST(Dem, UnknownUnitIsRefusedUnlessTheSceneFileNamesOne) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, plane);
  plan.unit = "furlong";
  WorldSpec spec = plane_scene(write_raster(folder, "odd.tif", plan));
  const std::string error = test::error_of(spec);
  EXPECT_NE(error.find("furlong"), std::string::npos) << error;
  EXPECT_NE(error.find("[terrain] unit"), std::string::npos) << error;
  spec.terrain.unit = VerticalUnit::metre;
  expect_plane(load_world(spec));
}

TEST(Dem, ScaleAndOffsetOfTheBandAreHonoured) {
  const Folder folder;
  RasterPlan plan = around(kLon, kLat, [](double lon, double lat) { return (plane(lon, lat) + 500) * 2000; });
  plan.type = "Float64";
  plan.scale = 0.0005;
  plan.offset = -500;
  expect_plane(load_world(plane_scene(write_raster(folder, "scaled.tif", plan))));
}

TEST(Dem, LaterFilesFillWhereEarlierOnesAreVoid) {
  const Folder folder;
  RasterPlan west = around(kLon, kLat, [](double lon, double) { return lon < kLon ? 10 : -9999; });
  west.nodata = -9999;
  RasterPlan all = around(kLon, kLat, [](double, double) { return 20; });
  WorldSpec spec = plane_scene(write_raster(folder, "west.tif", west));
  spec.terrain.dem.push_back(write_raster(folder, "all.tif", all));
  const World world = load_world(spec);
  EXPECT_NEAR(world.grid.height_at_m(-1000, 0), 10, 1e-3);
  EXPECT_NEAR(world.grid.height_at_m(1000, 0), 20, 1e-3);
  EXPECT_EQ(world.report.posts_absent, 0u);
}

TEST(Dem, TilesThatMeetWithoutOverlapLeaveNoCrack) {
  const Folder folder;
  RasterPlan west = around(kLon, kLat, plane);
  RasterPlan east = west;
  west.columns = 30;
  east.columns = 31;
  east.geotransform[0] += 30.0 / 1200;
  WorldSpec spec = plane_scene(write_raster(folder, "w.tif", west));
  spec.terrain.dem.push_back(write_raster(folder, "e.tif", east));
  spec.terrain.fill_void_m = 0;
  EXPECT_EQ(load_world(spec).report.posts_absent, 0u);
}

TEST(Dem, CellIsTheCoarserOfThePostingAndTheSamplingFootprint) {
  const Folder folder;
  const std::string dem = write_raster(folder, "a.tif", around(kLon, kLat, plane));
  WorldSpec spec = scene(kLon, kLat, 1500, {dem});
  // One 1/1200 degree at 33 N: 77.9 m by 92.4 m, of which the geometric mean is 84.8 m.
  EXPECT_NEAR(load_world(spec).grid.cell_m, 84.85, 0.1);
  EXPECT_EQ(std::remainder(load_world(spec).grid.cell_m, kGridQuantum_m), 0);
  spec.sampling_footprint_m = 120;
  EXPECT_EQ(load_world(spec).grid.cell_m, 120);
}

TEST(Dem, CoarseCellsTakeTheMeanOfThePostsTheyStandFor) {
  const Folder folder;
  // A checkerboard of +-50 m on 100 m: posts alone would alias into waves.
  RasterPlan plan = around(kLon, kLat, [](double lon, double lat) {
    const long odd = std::lround((lon - kLon) * 1200) + std::lround((lat - kLat) * 1200);
    return 100 + (odd % 2 == 0 ? 50 : -50);
  });
  plan.columns = plan.rows = 200;
  plan.geotransform[0] = kLon - 100.5 / 1200;
  plan.geotransform[3] = kLat + 100.5 / 1200;
  WorldSpec spec = scene(kLon, kLat, 6000, {write_raster(folder, "c.tif", plan)});
  spec.terrain.cell_m = 180;
  const World world = load_world(spec);
  for (float y : world.grid.y_m) ASSERT_NEAR(y, 100, 1e-3);
}

TEST(Dem, PartialCoverIsLoadedAndThePercentageThatIsMissingIsNoted) {
  const Folder folder;
  WorldSpec spec = scene(kLon, kLat, 1500, {write_raster(folder, "a.tif", around(kLon, kLat, plane))});
  spec.reaches[0].radius_m = 6000;
  const World world = load_world(spec);
  ASSERT_FALSE(world.report.notes.empty());
  // The raster is 61 x 77.86 m by 61 x 92.43 m (4.75 x 5.64 km) and the disc has 113.1 km2: 23.7 %.
  EXPECT_NE(world.report.notes[0].find("76."), std::string::npos) << world.report.notes[0];
}

TEST(Dem, LongitudesBeyondHalfATurnAreTheSamePlace) {
  const Folder folder;
  RasterPlan plan = around(kLon + 360, kLat, [](double lon, double lat) { return plane(lon - 360, lat); });
  expect_plane(load_world(plane_scene(write_raster(folder, "east.tif", plan))));
}

TEST(Dem, AntimeridianIsNoBorder) {
  const Folder folder;
  const auto value = [](double, double lat) { return 100 + 1000 * lat; };
  RasterPlan west = around(179.99, 10, value);
  west.columns = 43;  // 179.9646 .. 180.0004
  RasterPlan east = around(-179.98, 10, value);
  WorldSpec spec =
      scene(180, 10, 1500, {write_raster(folder, "w.tif", west), write_raster(folder, "e.tif", east)});
  const World world = load_world(spec);
  EXPECT_EQ(world.report.posts_absent, 0u);
  EXPECT_NEAR(world.grid.height_at_m(-700, 0), 10100, 0.1);
  EXPECT_NEAR(world.grid.height_at_m(700, 0), 10100, 0.1);
}

TEST(Dem, CentreIsTheMiddleOfTheUnion) {
  const Folder folder;
  TerrainSpec terrain;
  terrain.dem = {write_raster(folder, "a.tif", around(kLon, kLat, plane)),
                 write_raster(folder, "b.tif", around(kLon + 1, kLat - 0.5, plane))};
  const LonLat centre = dem_centre(terrain);
  EXPECT_NEAR(centre.longitude_deg, kLon + 0.5, 1e-9);
  EXPECT_NEAR(centre.latitude_deg, kLat - 0.25, 1e-9);
}

TEST(Dem, NodataNanInfinityAndMaskedPixelsAreVoids) {
  const Folder folder;
  const auto hole = [](double inside) {
    return [inside](double lon, double lat) {
      return std::abs(lon - kLon) < 4.2 / 1200 && std::abs(lat - kLat) < 4.2 / 1200 ? inside
                                                                                    : plane(lon, lat);
    };
  };
  const double quiet = kNan, endless = std::numeric_limits<double>::infinity();
  struct Case {
    const char* name;
    double inside;
    std::optional<double> nodata;
  };
  for (const Case& k : {Case{"nodata", -9999, -9999.0},
                        {"nan", quiet, {}},
                        {"inf", endless, {}},
                        {"nan tagged", quiet, quiet},
                        {"untagged", -32768, {}},
                        {"untagged 6", -999999, {}},
                        {"lowest float", -3.4028230607370965e+38, -3.4028230607370965e+38},
                        {"short tag", -3.4028234663852886e+38, -3.40282346638529e+38}}) {
    RasterPlan plan = around(kLon, kLat, hole(k.inside));
    plan.nodata = k.nodata;
    const World world = load_world(plane_scene(write_raster(folder, "hole.tif", plan)));
    EXPECT_TRUE(std::isnan(world.grid.height_at_m(0, 0))) << k.name;
    EXPECT_FALSE(std::isnan(world.grid.height_at_m(600, 0))) << k.name;
    EXPECT_GT(world.report.posts_absent, 600u) << k.name;
    EXPECT_LT(world.report.posts_absent, 1200u) << k.name;
  }
  RasterPlan plan = around(kLon, kLat, plane);
  plan.masked = [](int c, int r) { return std::abs(c - 30) < 5 && std::abs(r - 30) < 5; };
  const World world = load_world(plane_scene(write_raster(folder, "mask.tif", plan)));
  EXPECT_TRUE(std::isnan(world.grid.height_at_m(0, 0)));
  EXPECT_FALSE(std::isnan(world.grid.height_at_m(600, 0)));
}

TEST(Dem, SameBitsForAnyNumberOfThreads) {
  const Folder folder;
  const std::string dem = write_raster(folder, "a.tif", around(kLon, kLat, [](double x, double y) {
                                         return 300 * std::sin(900 * x) * std::cos(700 * y);
                                       }));
  WorldSpec spec = plane_scene(dem);
  spec.terrain.cell_m = 7;
  spec.prisms.emplace_back();
  std::vector<World> worlds;
  for (std::size_t threads : {1u, 2u, 8u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    worlds.push_back(load_world(spec));
  }
  for (const World& world : worlds) {
    EXPECT_EQ(world.grid.y_m, worlds[0].grid.y_m);
    EXPECT_EQ(world.buildings.ring_xz_m, worlds[0].buildings.ring_xz_m);
  }
}

TEST(Dem, ProgressIsToldWithinZeroAndOne) {
  const Folder folder;
  int calls = 0;
  load_world(plane_scene(write_raster(folder, "a.tif", around(kLon, kLat, plane))),
             [&](std::string_view stage, double fraction) {
               ++calls;
               EXPECT_FALSE(stage.empty());
               EXPECT_GE(fraction, 0);
               EXPECT_LE(fraction, 1);
             });
  EXPECT_GT(calls, 0);
}

SourceExtents of(const std::vector<std::vector<LonLat>>& edges) {
  SourceExtents extents("terrain.dem");
  for (const auto& edge : edges) extents.add(edge);
  return extents;
}

/// One degree of longitude and latitude, at the equator.
const std::vector<LonLat> kDegree{{10, 0}, {11, 0}, {11, 1}, {10, 1}};

TEST(SourceExtents, MadeUpGroundIsEverywhere) {
  const SourceExtents made_up;
  EXPECT_TRUE(made_up.covers({123, 45}));
  EXPECT_TRUE(made_up.reaches({123, 45}, 1));
  EXPECT_EQ(made_up.share({123, 45}, 1e5), 1);
}

TEST(SourceExtents, CoverWhatLiesWithinAFileWhicheverTurnItsLongitudesAreOf) {
  const SourceExtents files = of({kDegree, {{-60, 40}, {-59, 41}}});
  EXPECT_TRUE(files.covers({10.5, 0.5}));
  EXPECT_TRUE(files.covers({370.5, 0.5}));
  EXPECT_TRUE(files.covers({-59.5, 40.5}));
  EXPECT_FALSE(files.covers({10.5, 1.01}));
  EXPECT_FALSE(files.covers({-20, 20})) << "between the files";
  EXPECT_EQ(files.text(), "terrain.dem covers longitude -60.0000 to 11.0000, latitude 0.0000 to 41.0000");
}

TEST(SourceExtents, CrossTheAntimeridian) {
  const SourceExtents files = of({{{179.5, 0}, {-179.5, 0}, {-179.5, 1}, {179.5, 1}}});
  EXPECT_TRUE(files.covers({180, 0.5}));
  EXPECT_TRUE(files.covers({-179.6, 0.5}));
  EXPECT_FALSE(files.covers({0, 0.5}));
}

TEST(SourceExtents, AreReachedFromOutsideAsFarAsTheGreatCircleSays) {
  const SourceExtents files = of({kDegree});
  // A degree of latitude at the equator of WGS84 is 110.574 km.
  EXPECT_FALSE(files.reaches({10.5, 2}, 110500));
  EXPECT_TRUE(files.reaches({10.5, 2}, 110650));
}

TEST(SourceExtents, HalfOfADiscOnTheEdgeIsCovered) {
  const SourceExtents files = of({kDegree});
  EXPECT_EQ(files.share({10.5, 0.5}, 10000), 1);
  EXPECT_EQ(files.share({50, 0.5}, 10000), 0);
  EXPECT_NEAR(files.share({10.5, 1.00001}, 10000), 0.5, 0.07)
      << "16 places on a ring: 2 of them lie on the edge";
}

TEST(SourceExtents, EndWhereTheAreaDoes) {
  SourceExtents files = of({kDegree, {{30, 0}, {31, 1}}});
  const std::vector<LonLat> area{{10.5, 0.5}, {12, 0.5}, {12, 3}};
  files.cut_to(area);
  EXPECT_TRUE(files.covers({10.75, 0.75}));
  EXPECT_FALSE(files.covers({10.25, 0.75}));
  EXPECT_FALSE(files.covers({30.5, 0.5}));
  EXPECT_EQ(files.text(),
            "terrain.dem within terrain.area covers longitude 10.5000 to 11.0000, latitude 0.5000 to 1.0000");
}

}  // namespace
}  // namespace obliq::test::dem_test
