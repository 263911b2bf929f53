#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

using test::around;
using test::error_of;
using test::Folder;
using test::RasterPlan;
using test::scene;
using test::write_raster;

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
}  // namespace obliq
