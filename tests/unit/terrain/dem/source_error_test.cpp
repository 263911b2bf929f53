// The vertical error of the grid against its source's posts, against closed forms and another program.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "terrain/base/units.h"
#include "tests/unit/terrain_files.h"

namespace obliq::source_error_test {
namespace {

using test::Folder;
using test::RasterPlan;
using test::scene;
using test::write_raster;

constexpr double kLon = -99.5;
constexpr double kLat = 33;

/// Metres of a degree of longitude at kLat and of latitude, WGS84 (closed form of the two radii of
/// curvature).
struct Degree {
  double east_m, north_m;
};
Degree degree_lengths() {
  const double a = 6378137, e2 = 0.00669437999014, s = std::sin(kLat * kDegree_rad);
  const double w = std::sqrt(1 - e2 * s * s);
  return {a / w * std::cos(kLat * kDegree_rad) * kDegree_rad, a * (1 - e2) / (w * w * w) * kDegree_rad};
}

/// z = amplitude sin(k x), x east: 10 m posts over 4 x 4 km.
RasterPlan waves(double amplitude_m, double k_per_m) {
  const Degree degree = degree_lengths();
  RasterPlan plan;
  plan.columns = plan.rows = 401;
  const double dx = 10 / degree.east_m, dy = 10 / degree.north_m;
  plan.geotransform = {kLon - 200.5 * dx, dx, 0, kLat + 200.5 * dy, 0, -dy};
  plan.value = [=](double lon, double) {
    return 200 + amplitude_m * std::sin(k_per_m * (lon - kLon) * degree.east_m);
  };
  return plan;
}

SourceError error_of_cell(const std::string& dem, double cell_m) {
  WorldSpec spec = scene(kLon, kLat, 1500, {dem});
  spec.terrain.cell_m = cell_m;
  return load_world(spec).report.source_error;
}

TEST(SourceError, OfSineWavesIsThatOfStraightChords) {
  const Folder folder;
  constexpr double kAmplitude_m = 20, kWave_m = 400;
  const double k = 2 * M_PI / kWave_m;
  const std::string dem = write_raster(folder, "waves.tif", waves(kAmplitude_m, k));
  // A chord of length c lies at most c^2 k^2 a / 8 off, where the curve bends most, and over all posts
  // f c^2 k^2 a / 2 with f = s (1 - s) of the place in the cell: mean square of f is 1/30, of sin^2 1/2. The
  // source's own 10 m chords, which give the nodes, leave c = 10 m of the same.
  const auto bound_m = [&](double cell_m) { return cell_m * cell_m * k * k * kAmplitude_m / 8; };
  for (const double cell_m : {19.0, 13.0}) {
    const SourceError error = error_of_cell(dem, cell_m);
    const double rms_m = cell_m * cell_m * k * k * kAmplitude_m / 2 * std::sqrt(1.0 / 30 / 2);
    EXPECT_GT(error.posts, 30000u);
    EXPECT_LE(error.greatest_m, bound_m(cell_m) + bound_m(10) + 1e-3) << cell_m;
    EXPECT_GT(error.greatest_m, 0.9 * bound_m(cell_m)) << cell_m;
    EXPECT_GT(error.rms_m, 0.95 * rms_m) << cell_m;
    EXPECT_LT(error.rms_m, rms_m + bound_m(10)) << cell_m;
    EXPECT_LT(error.median_m, error.p95_m);
    EXPECT_LT(error.p95_m, error.greatest_m);
  }
}

TEST(SourceError, OfAPlaneIsNothing) {
  const Folder folder;
  RasterPlan plan = waves(0, 0);
  plan.value = [](double lon, double lat) { return 100 + 5000 * (lon - kLon) - 3000 * (lat - kLat); };
  // Float32 at 100 m, and cells of 25 m over a plane in degrees (dem_test.cpp): 2 mm. Heights compared
  // half a posting beside their place would be off by 0.25 m.
  EXPECT_LT(error_of_cell(write_raster(folder, "plane.tif", plan), 25).greatest_m, 2e-3);
}

TEST(SourceError, CoarseCellsAreComparedWithEveryPostNotWithTheirMeans) {
  const Folder folder;
  // Two postings a wave: the posts alternate by +-5 m, their means over 4 x 4 posts are flat.
  RasterPlan plan = waves(0, 0);
  const double west = plan.geotransform[0], dx = plan.geotransform[1];
  plan.value = [=](double lon, double) {
    return std::lround((lon - west) / dx - 0.5) % 2 == 0 ? 205.0 : 195.0;
  };
  const SourceError error = error_of_cell(write_raster(folder, "comb.tif", plan), 41);
  EXPECT_NEAR(error.median_m, 5, 0.01);
  EXPECT_NEAR(error.rms_m, 5, 0.01);
}

TEST(SourceError, LeavesOutFilledVoidsAndGroundOfEarlierFiles) {
  const Folder folder;
  RasterPlan flat = waves(0, 0);
  flat.value = [](double, double) { return 200.0; };
  flat.nodata = -9999;
  // A hole of 100 m, and a second file 50 m higher that is only asked for the eastern part.
  RasterPlan holed = flat;
  const Degree degree = degree_lengths();
  holed.value = [=](double lon, double lat) {
    const double x = (lon - kLon) * degree.east_m, z = (lat - kLat) * degree.north_m;
    if (x > 700) return -9999.0;
    return std::abs(x) < 50 && std::abs(z) < 50 ? -9999.0 : 200.0;
  };
  RasterPlan higher = flat;
  higher.value = [=](double lon, double) { return (lon - kLon) * degree.east_m < 300 ? 900.0 : 250.0; };
  WorldSpec spec = scene(kLon, kLat, 1500, {write_raster(folder, "holed.tif", holed)});
  spec.terrain.cell_m = 10;
  spec.terrain.dem.push_back(write_raster(folder, "higher.tif", higher));
  spec.terrain.area = {{kLon - 0.01, kLat - 0.01},
                       {kLon + 0.01, kLat - 0.01},
                       {kLon + 0.01, kLat + 0.01},
                       {kLon - 0.01, kLat + 0.01}};
  const SourceError error = load_world(spec).report.source_error;
  // 900 m posts over 200 m ground would show as 700 m; the hole takes its heights from the second file.
  EXPECT_LT(error.greatest_m, 1e-3);
  EXPECT_GT(error.posts, 20000u);
}

TEST(SourceError, IsTheSameEveryTimeAndCountsOnlyTheArea) {
  const Folder folder;
  const std::string dem = write_raster(folder, "waves.tif", waves(20, 0.01));
  EXPECT_EQ(error_of_cell(dem, 17).rms_m, error_of_cell(dem, 17).rms_m);
  WorldSpec spec = scene(kLon, kLat, 1500, {dem});
  spec.terrain.cell_m = 17;
  const SourceError whole = load_world(spec).report.source_error;
  spec.terrain.area = {{kLon - 0.005, kLat - 0.005}, {kLon + 0.005, kLat - 0.005}, {kLon, kLat + 0.005}};
  const SourceError part = load_world(spec).report.source_error;
  EXPECT_LT(part.posts, whole.posts / 4);
  EXPECT_GT(part.posts, 1000u);
}

TEST(SourceError, OfSyntheticGroundIsMeasuredAgainstItsShape) {
  WorldSpec spec = scene(kLon, kLat, 5000, {});
  spec.terrain.synthetic = SyntheticKind::ramp;
  spec.terrain.cell_m = 50;
  EXPECT_LT(load_world(spec).report.source_error.greatest_m, 1e-3);  // float32 at 250 m: 15 micrometres
  spec.terrain.synthetic = SyntheticKind::ridge;
  spec.terrain.shape = {.height_m = 100, .distance_m = 25, .width_m = 2000};
  // The crest lies half-way between nodes: the chord cuts off cell / 2 x slope 0.1, everything else is
  // planar.
  const SourceError error = load_world(spec).report.source_error;
  EXPECT_NEAR(error.greatest_m, 2.5, 0.2);
  EXPECT_LT(error.median_m, 1e-3);
}

/// The program prints one value a line.
std::vector<double> run_gdallocationinfo(const std::string& dem, const std::string& positions) {
  std::vector<double> values;
  FILE* pipe = popen(
      ("gdallocationinfo -valonly -wgs84 '" + dem + "' < '" + positions + "' 2>/dev/null").c_str(), "r");
  char line[128];
  while (pipe && std::fgets(line, sizeof line, pipe)) values.push_back(std::atof(line));
  if (pipe) pclose(pipe);
  return values;
}

TEST(SourceError, OfRealGroundIsWhatGdallocationinfoSays) {
  const std::string name = "la_nasadem_30m/NASADEM_HGT_n34w119.tif";
  const std::string dem = test::shared_file(name);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(name);
  if (std::system("gdallocationinfo --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "no gdallocationinfo here";
  WorldSpec spec = scene(-118.3, 34.3, 15000, {dem});
  spec.terrain.cell_m = 45;
  const World world = load_world(spec);
  // Posts of this file stand on whole arc seconds.
  const Folder folder;
  std::mt19937 random(5);
  std::vector<LonLat> places;
  std::ofstream list(folder.file("places.txt"));
  for (int n = 0; n < 4000; ++n) {
    // A little more than the square of 15 km around the origin that is loaded.
    const auto east = static_cast<int>(random() % 1200), north = static_cast<int>(random() % 1000);
    const LonLat at{-118.3 + (east - 600) / 3600.0, 34.3 + (north - 500) / 3600.0};
    places.push_back(at);
    char line[80];
    std::snprintf(line, sizeof line, "%.12f %.12f\n", at.longitude_deg, at.latitude_deg);
    list << line;
  }
  list.close();
  const std::vector<double> heights_m = run_gdallocationinfo(dem, folder.file("places.txt"));
  ASSERT_EQ(heights_m.size(), places.size());
  std::vector<double> errors_m;
  double squares = 0;
  for (std::size_t n = 0; n < places.size(); ++n) {
    const double ground_y_m =
        test::ground_at(world, places[n].longitude_deg, places[n].latitude_deg, heights_m[n]);
    if (std::isnan(ground_y_m)) continue;
    const WorldPoint post = world.frame.world_from_geodetic(
        {places[n].latitude_deg * kDegree_rad, places[n].longitude_deg * kDegree_rad, heights_m[n]});
    errors_m.push_back(std::abs(ground_y_m - post.m.y));
    squares += errors_m.back() * errors_m.back();
  }
  ASSERT_GT(errors_m.size(), 3500u);
  std::sort(errors_m.begin(), errors_m.end());
  const SourceError& error = world.report.source_error;
  const double rms_m = std::sqrt(squares / static_cast<double>(errors_m.size()));
  // Two random samples of one distribution, 4,000 posts here: 10 % is five standard errors of a median.
  EXPECT_NEAR(error.median_m, errors_m[errors_m.size() / 2], 0.1 * error.median_m);
  EXPECT_NEAR(error.p95_m, errors_m[errors_m.size() * 95 / 100], 0.1 * error.p95_m);
  EXPECT_NEAR(error.rms_m, rms_m, 0.15 * rms_m);
  EXPECT_GT(error.posts, 100000u);
}

using test::around;
using test::error_of;

double hill(double lon, double lat) { return 200 + 1000 * std::sin(90 * lon) * std::cos(70 * lat); }

WorldSpec bad(const std::string& dem) { return scene(-99.5, 33, 1500, {dem}); }

void expect_named(const std::string& error, const std::string& path) {
  EXPECT_NE(error.find("[terrain] dem"), std::string::npos) << error;
  EXPECT_NE(error.find(path), std::string::npos) << error;
}

void cut(const std::string& path, double fraction) {
  const auto size = static_cast<double>(std::filesystem::file_size(path));
  std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size * fraction));
}

TEST(BadDem, MissingFileIsNamed) {
  const Folder folder;
  expect_named(error_of(bad(folder.file("none.tif"))), "none.tif");
  expect_named(error_of(bad("")), "empty name");
}

TEST(BadDem, EmptyTextAndFolderAreRefusedByName) {
  const Folder folder;
  expect_named(error_of(bad(folder.text("empty.tif", ""))), "empty.tif");
  expect_named(error_of(bad(folder.text("words.tif", "These are words, not heights.\n"))), "words.tif");
  expect_named(error_of(bad(folder.file(""))), folder.file(""));
}

TEST(BadDem, VectorFileIsSaidToBeOne) {
  const Folder folder;
  const std::string path =
      folder.text("v.geojson", R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},)"
                               R"("geometry":{"type":"Point","coordinates":[-99.5,33]}}]})");
  const std::string error = error_of(bad(path));
  expect_named(error, "v.geojson");
  EXPECT_NE(error.find("vectors only"), std::string::npos) << error;
}

TEST(BadDem, TruncatedFilesOfAnyKindAreErrorsAndNeverZeros) {
  const Folder folder;
  for (const char* option : {"COMPRESS=NONE", "COMPRESS=DEFLATE", "TILED=YES"}) {
    for (double keep : {0.02, 0.3, 0.6, 0.95}) {
      RasterPlan plan = around(-99.5, 33, hill);
      plan.options = {option};
      const std::string path = write_raster(folder, "cut.tif", plan);
      cut(path, keep);
      expect_named(error_of(bad(path)), "cut.tif");
    }
  }
  struct Kind {
    const char* driver;
    const char* name;
  };
  for (const Kind& kind :
       {Kind{"EHdr", "cut.bil"}, {"ENVI", "cut.dat"}, {"AAIGrid", "cut.asc"}, {"HFA", "cut.img"}}) {
    RasterPlan plan = around(-99.5, 33, hill);
    plan.driver = kind.driver;
    plan.geotransform = {-99.5 - 30.5 / 1024, 1.0 / 1024, 0, 33 + 30.5 / 1024, 0, -1.0 / 1024};
    const std::string path = write_raster(folder, kind.name, plan);
    EXPECT_EQ(error_of(bad(path)), "no error") << kind.driver;
    cut(path, 0.6);
    expect_named(error_of(bad(path)), kind.name);
  }
}

// GDAL 3.6 looks for a missing row of a text grid twice as often for each row behind it: 2^130 times here.
TEST(BadDem, TextGridThatEndsLongBeforeTheScenesRowsIsRefusedAtOnce) {
  const Folder folder;
  RasterPlan plan = around(-99.5, 33, hill);
  plan.driver = "AAIGrid";
  plan.columns = plan.rows = 401;
  plan.geotransform = {-99.5 - 200.5 / 1024, 1.0 / 1024, 0, 33 + 200.5 / 1024, 0, -1.0 / 1024};
  const std::string path = write_raster(folder, "cut.asc", plan);
  folder.text("of_cut.vrt", R"(<VRTDataset rasterXSize="401" rasterYSize="401"><SRS>EPSG:4326</SRS>
    <GeoTransform>-99.69580078125, 0.0009765625, 0, 33.19580078125, 0, -0.0009765625</GeoTransform>
    <VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="1">cut.asc</SourceFilename>
    <SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="401" ySize="401"/>
    <DstRect xOff="0" yOff="0" xSize="401" ySize="401"/></SimpleSource></VRTRasterBand></VRTDataset>)");
  EXPECT_EQ(error_of(bad(path)), "no error");
  EXPECT_EQ(error_of(bad(folder.file("of_cut.vrt"))), "no error");
  cut(path, 0.1);
  for (const char* name : {"cut.asc", "of_cut.vrt"}) {
    const std::string error = error_of(bad(folder.file(name)));
    expect_named(error, name);
    EXPECT_NE(error.find("cannot be read"), std::string::npos) << error;
  }
}

TEST(BadDem, ShortGridFloatFileIsNotTakenForOneOfBytes) {
  const Folder folder;
  folder.text("g.hdr",
              "ncols 61\nnrows 61\nxllcorner -99.525\nyllcorner 32.975\ncellsize 0.0008\n"
              "NODATA_value -9999\nbyteorder LSBFIRST\n");
  folder.text("g.prj",
              "GEOGCS[\"NAD83\",DATUM[\"North_American_Datum_1983\",SPHEROID[\"GRS 1980\",6378137,"
              "298.257222101]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]");
  for (double keep : {0.3, 0.6, 0.9, 1.0}) {
    const std::size_t bytes = 61 * 61 * 4;
    const std::string path = folder.text("g.flt", std::string(static_cast<std::size_t>(keep * bytes), '\0'));
    if (keep == 1.0) {
      EXPECT_EQ(error_of(bad(path)), "no error");
    } else {
      expect_named(error_of(bad(path)), "g.flt");
    }
  }
}

TEST(BadDem, RasterWithoutCoordinateSystemNamesTheKeyThatGivesOne) {
  const Folder folder;
  RasterPlan plan = around(-99.5, 33, hill);
  plan.crs = "";
  WorldSpec spec = bad(write_raster(folder, "bare.tif", plan));
  const std::string error = error_of(spec);
  expect_named(error, "bare.tif");
  EXPECT_NE(error.find("[terrain] crs"), std::string::npos) << error;
  spec.terrain.crs = "EPSG:4269";
  EXPECT_EQ(error_of(spec), "no error");
  spec.terrain.crs = "EPSG:nonsense";
  EXPECT_NE(error_of(spec).find("[terrain] crs: found \"EPSG:nonsense\""), std::string::npos)
      << error_of(spec);
}

TEST(BadDem, RasterWithoutPlaceOnTheEarthIsRefused) {
  const Folder folder;
  RasterPlan plan = around(-99.5, 33, hill);
  plan.geotransform = {0, 1, 0, 0, 0, 1};  // GDAL's word for none
  plan.crs = "";
  plan.driver = "PNG";
  plan.type = "Byte";
  expect_named(error_of(bad(write_raster(folder, "picture.png", plan))), "picture.png");
  plan = around(-99.5, 33, hill);
  plan.geotransform = {500000, 30, 0, 4000000, 0, -30};  // metres said to be degrees
  expect_named(error_of(bad(write_raster(folder, "metres.tif", plan))), "metres.tif");
}

TEST(BadDem, ElevationElsewhereSaysBothPlaces) {
  const Folder folder;
  const std::string error = error_of(bad(write_raster(folder, "far.tif", around(-90, 33, hill))));
  expect_named(error, "far.tif");
  EXPECT_NE(error.find("longitude -90.0254 to -89.9746"), std::string::npos) << error;
  EXPECT_NE(error.find("longitude -99.51"), std::string::npos) << error;
}

TEST(BadDem, NothingButVoidsIsAnError) {
  const Folder folder;
  RasterPlan plan = around(-99.5, 33, [](double, double) { return -9999; });
  plan.nodata = -9999;
  const std::string error = error_of(bad(write_raster(folder, "void.tif", plan)));
  expect_named(error, "void.tif");
  EXPECT_NE(error.find("no height in the wanted area"), std::string::npos) << error;
}

TEST(BadDem, BadNumbersInTheSpecificationAreRefused) {
  const Folder folder;
  WorldSpec spec = bad(write_raster(folder, "good.tif", around(-99.5, 33, hill)));
  spec.terrain.fill_void_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of(spec).find("fill_void_m"), std::string::npos);
  spec.terrain.fill_void_m = 200;
  spec.terrain.cell_m = -5;
  EXPECT_NE(error_of(spec).find("cell_m"), std::string::npos);
  spec.terrain.cell_m = 0.04;
  spec.reaches[0].radius_m = 1e9;
  EXPECT_NE(error_of(spec).find("cell_m and area"), std::string::npos) << error_of(spec);
}

TEST(BadDem, SceneWithoutAnyTerrainIsRefused) {
  EXPECT_NE(error_of(scene(0, 0, 1000, {})).find("[terrain] dem"), std::string::npos);
}

}  // namespace
}  // namespace obliq::source_error_test
