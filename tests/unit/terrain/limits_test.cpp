// Small files that would take hours or all memory to load, and what is odd about files that do
// load.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "terrain/base/errors.h"
#include "terrain/buildings/height_text.h"
#include "terrain/polygon.h"
#include "tests/unit/terrain_outlines.h"

namespace obliq::limits_test {
namespace {

using test::Folder;
using test::polygon_feature;
using test::square;
using test::town;
using test::town_frame;

double hill(double lon, double lat) { return 200 + 100 * std::sin(90 * lon) * std::cos(70 * lat); }

/// A virtual raster of side x side pixels over 0.04 degrees around the scene's origin, all of them from
/// small.tif; `band` is put into the band.
std::string virtual_raster(const Folder& folder, long side, const std::string& band = "") {
  test::RasterPlan plan = test::around(-99.5, 33, hill);
  plan.columns = plan.rows = 512;
  plan.geotransform = {-99.52, 0.04 / 512, 0, 33.02, 0, -0.04 / 512};
  test::write_raster(folder, "small.tif", plan);
  const std::string n = std::to_string(side);
  const std::string pixel = std::to_string(0.04 / static_cast<double>(side) * 1e9) + "e-9";
  const std::string source =
      "<SourceFilename relativeToVRT=\"1\">small.tif</SourceFilename><SourceBand>1</SourceBand>";
  return folder.text("big.vrt",
                     "<VRTDataset rasterXSize=\"" + n + "\" rasterYSize=\"" + n +
                         "\"><SRS>EPSG:4326</SRS><GeoTransform>-99.52," + pixel + ",0,33.02,0,-" + pixel +
                         "</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\">" + band +
                         "<SimpleSource>" + source +
                         "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"512\" ySize=\"512\"/><DstRect xOff=\"0\" "
                         "yOff=\"0\" xSize=\"" +
                         n + "\" ySize=\"" + n + "\"/></SimpleSource></VRTRasterBand></VRTDataset>");
}

WorldSpec over(const std::string& dem) {
  WorldSpec spec = test::scene(-99.5, 33, 1500, {dem});
  spec.terrain.cell_m = 25;
  return spec;
}

TEST(Limits, RasterOfMorePixelsThanCanBeReadIsRefusedByNameAndCount) {
  const Folder folder;
  for (const long side : {1000000L, 2147483647L}) {
    const std::string error = test::error_of(over(virtual_raster(folder, side)));
    EXPECT_NE(error.find("big.vrt"), std::string::npos) << error;
    EXPECT_NE(error.find("of its pixels"), std::string::npos) << error;
    EXPECT_NE(error.find("allowed: 2.1e+09"), std::string::npos) << error;
  }
}

TEST(Limits, OverviewIsReadWhereTheRasterItselfIsTooLarge) {
  const Folder folder;
  const std::string dem =
      virtual_raster(folder, 131072,
                     "<Overview><SourceFilename "
                     "relativeToVRT=\"1\">small.tif</SourceFilename><SourceBand>1</SourceBand></Overview>");
  const World world = load_world(over(dem));
  for (const double lon : {-99.511, -99.5, -99.49}) {
    for (const double lat : {32.99, 33.003, 33.01}) {
      // 25 m cells of a hill of 100 m with slopes up to 0.15: the mean over a cell is within decimetres.
      EXPECT_NEAR(test::ground_at(world, lon, lat, 200), hill(lon, lat), 1.0) << lon << ' ' << lat;
    }
  }
}

/// n corners on a circle, every second at a radius of its own choice.
test::MetreRing ring_of(int n, const std::function<double(int)>& radius_m) {
  test::MetreRing ring;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * k / n;
    ring.emplace_back(radius_m(k) * std::cos(angle), radius_m(k) * std::sin(angle));
  }
  return ring;
}

test::MetreRing random_ring(int n) {
  std::mt19937 dice(1);
  test::MetreRing ring;
  for (int k = 0; k < n; ++k) {
    const double east_m = static_cast<double>(dice() % 2000) / 10;
    ring.emplace_back(east_m, static_cast<double>(dice() % 2000) / 10);
  }
  return ring;
}

void expect_skipped(const World& world, const std::string& found) {
  EXPECT_EQ(world.report.buildings_too_complex, 1u);
  EXPECT_EQ(world.buildings.list.size(), 1u) << "the house beside it stands";
  ASSERT_FALSE(world.report.warnings.empty());
  const std::string& warning = world.report.warnings.back();
  EXPECT_NE(warning.find("town.geojson, feature 1: found " + found), std::string::npos) << warning;
  EXPECT_NE(warning.find("allowed: "), std::string::npos) << warning;
}

TEST(Limits, OutlinesThatWouldTakeMinutesAreSkippedAndTheFirstIsNamed) {
  const Folder folder;
  const std::string house = polygon_feature(town_frame(), {square(300, 0, 10)}, R"("height":5)");
  const auto with = [&](const test::MetreRing& ring) {
    return town(folder, {house, polygon_feature(town_frame(), {ring}, R"("height":5)")});
  };
  expect_skipped(with(ring_of(1000000, [](int) { return 200.0; })), "1000000 corners; allowed: 4096");
  expect_skipped(with(ring_of(20000, [](int k) { return k % 2 ? 200.0 : 100.0 + k % 97; })), "20000 corners");
  expect_skipped(with(random_ring(3000)),
                 "more than 1024 places where its edges cross or touch; allowed: 1024");
}

TEST(Limits, OutlineOfManyCornersAndOneThatCrossesItselfAFewTimesStillStand) {
  const Folder folder;
  const World world = town(
      folder, {polygon_feature(town_frame(), {ring_of(2000, [](int k) { return k % 2 ? 200.0 : 150.0; })},
                               R"("height":5)"),
               polygon_feature(town_frame(), {{{300, 0}, {310, 10}, {310, 0}, {300, 10}}}, R"("height":5)")});
  EXPECT_EQ(world.report.buildings_too_complex, 0u);
  EXPECT_EQ(world.buildings.list.size(), 3u);  // a bow tie is two
  EXPECT_EQ(world.report.buildings_repaired, 1u);
}

TEST(Limits, CrossingsAreCountedOnceEachAndNeighboursNotAtAll) {
  EXPECT_EQ(count_crossings({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}, 100), 0u);
  EXPECT_EQ(count_crossings({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, 100), 1u);
  // A pentagram's five edges meet each of the two that are no neighbours.
  EXPECT_EQ(count_crossings({{{0, 3}, {2, -3}, {-3, 1}, {3, 1}, {-2, -3}}}, 100), 5u);
  EXPECT_EQ(count_crossings({{{0, 3}, {2, -3}, {-3, 1}, {3, 1}, {-2, -3}}}, 3), 3u);
  // A hole that reaches out of its ring crosses it twice.
  EXPECT_EQ(count_crossings({{{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {{5, 5}, {20, 5}, {5, 6}}}, 100), 2u);
}

TEST(Limits, ATownOfBadFootprintsLoadsAndEachKindIsCounted) {
  // 20,000 houses of 8 m, 20 m apart; each again, each a hand's breadth further east, and what else data sets
  // have.
  const Folder folder;
  const WorldFrame frame = town_frame();
  std::vector<std::string> features;
  const auto add = [&](const test::MetreRing& ring) {
    features.push_back(polygon_feature(frame, {ring}, R"("height":5)"));
  };
  constexpr int kHouses = 20000;
  for (const double shift_m : {0.0, 0.0, 0.15})
    for (int k = 0; k < kHouses; ++k) add(square(shift_m - 1400 + 20 * (k % 141), -1400 + 20 * (k / 141), 8));
  for (int k = 0; k < 1000; ++k) add(square(-1390 + k, 1500, 0.001));
  for (int k = 0; k < 1000; ++k) {
    const double east = -1390 + 2 * k;
    add({{east, 1510}, {east + 0.05, 1510}, {east + 0.05, 1540}, {east, 1540}});
  }
  for (int k = 0; k < 100; ++k) add(square(-5000 - k, -5000, 10000));
  for (int k = 0; k < 100; ++k) add(square(-2000 - k, -2000, 4900));
  WorldSpec spec = test::scene(-99.5, 33, 8000, {});
  spec.terrain.synthetic = SyntheticKind::flat;
  spec.terrain.cell_m = 100;
  const World world = town(folder, features, spec);
  const LoadReport& report = world.report;
  EXPECT_EQ(report.buildings_read, features.size());
  EXPECT_EQ(report.buildings_duplicate, 20000u);
  EXPECT_EQ(report.buildings_zero_area, 1000u);
  EXPECT_EQ(report.buildings_too_wide, 100u);
  EXPECT_EQ(report.buildings_slivers, 1000u);
  EXPECT_EQ(report.buildings_copies, 20000u);
  EXPECT_EQ(world.buildings.list.size(), 20000u + 20000u + 1000u + 100u);
  EXPECT_EQ(report.buildings_kept, world.buildings.list.size());
}

TEST(Limits, OutlineAroundAllThatIsLoadedIsSaidToBe) {
  const Folder folder;
  const std::string earth = R"([[[-179,-85],[179,-85],[179,85],[-179,85],[-179,-85]]])";
  const World world = town(folder, {test::feature("Polygon", earth, R"("height":5)")});
  EXPECT_EQ(world.report.buildings_around, 1u);
  EXPECT_EQ(world.report.buildings_outside, 0u);
}

TEST(Limits, RefusedHeightsAreCountedAndTheFirstIsSaid) {
  const Folder folder;
  std::vector<std::string> features = {
      polygon_feature(town_frame(), {square(-50, 0, 10)}, R"("height":"4")")};
  for (const char* height : {R"("-5")", R"("0")", R"("1e9")", R"("NaN")", R"("inf")"}) {
    features.push_back(polygon_feature(town_frame(),
                                       {square(20.0 * static_cast<double>(features.size()), 0, 10)},
                                       std::string(R"("height":)") + height));
  }
  const World world = town(folder, features);
  EXPECT_EQ(world.report.buildings_default_height, 5u);
  ASSERT_EQ(world.report.warnings.size(), 1u);
  EXPECT_EQ(
      world.report.warnings[0],
      "[[buildings]] town.geojson: 5 heights were refused and became 8 m (default_height_m), the first is "
      "\"-5\" of feature 1; allowed: more than 0, at most 2000 m");
}

TEST(Limits, HeightFieldThatIsNotThereIsAnErrorWithTheFieldsThereAre) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].height_field = "HEIGHT";
  spec.buildings[0].source =
      folder.text("town.geojson", test::collection({polygon_feature(town_frame(), {square(0, 0, 10)},
                                                                    R"("OBJECTID":1,"HEIGHT_ft":21)")}));
  const std::string error = test::error_of(spec);
  EXPECT_NE(error.find("town.geojson: it has no field \"HEIGHT\""), std::string::npos) << error;
  EXPECT_NE(error.find("OBJECTID, HEIGHT_ft"), std::string::npos) << error;
}

TEST(Limits, HeightsAreReportedAndFeetSuspectedByNameAndBySize) {
  const Folder folder;
  const auto loaded = [&](const std::string& field, const std::string& unit, double scale) {
    std::vector<std::string> features;
    for (int k = 0; k < 101; ++k) {
      // 3 to 8 m, every value as often as any other.
      features.push_back(polygon_feature(town_frame(), {square(-900 + 15.0 * k, 0, 10)},
                                         "\"" + field + "\":" + std::to_string(scale * (3 + 0.05 * k))));
    }
    WorldSpec spec = test::flat_town();
    spec.buildings.emplace_back();
    spec.buildings[0].height_field = field;
    spec.buildings[0].unit = unit;
    return town(folder, features, spec).report;
  };
  const LoadReport metres = loaded("height", "", 1);
  EXPECT_TRUE(metres.warnings.empty());
  ASSERT_EQ(metres.building_heights.size(), 1u);
  const BuildingHeights& heights = metres.building_heights[0];
  EXPECT_EQ(heights.found, 101u);
  EXPECT_NEAR(heights.least_m, 3, 1e-9);
  EXPECT_NEAR(heights.median_m, 5.5, 1e-9);
  EXPECT_NEAR(heights.most_m, 8, 1e-9);
  EXPECT_EQ(heights.file + ' ' + heights.field + ' ' + heights.unit, "town.geojson height m");

  const double feet = 1 / 0.3048;
  EXPECT_TRUE(loaded("HEIGHT_ft", "ft", feet).warnings.empty());
  EXPECT_TRUE(loaded("height", "m", feet).warnings.empty()) << "who names metres has looked";
  for (const LoadReport& report :
       {loaded("HEIGHT_ft", "", 1), loaded("HEIGHT_FT", "m", 1), loaded("height", "", feet)}) {
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("unit = \"ft\""), std::string::npos) << report.warnings[0];
  }
}

TEST(Limits, ElevationSaysItsUnitWhetherThatIsAssumedAndHowFarItReaches) {
  const Folder folder;
  test::RasterPlan plan =
      test::around(-99.5, 33, [](double lon, double) { return 100 + (lon + 99.5) * 1000; });
  const auto report = [&] {
    return load_world(test::scene(-99.5, 33, 1500, {test::write_raster(folder, "hill.tif", plan)})).report;
  };
  const LoadReport bare = report();
  ASSERT_EQ(bare.elevation.size(), 1u);
  EXPECT_EQ(bare.elevation[0].file, "hill.tif");
  EXPECT_EQ(bare.elevation[0].unit, "m");
  EXPECT_TRUE(bare.elevation[0].unit_assumed);
  // 1500 m of longitude at 33 degrees north are 0.01605 degrees, and the outermost node is within a cell.
  EXPECT_NEAR(bare.lowest_m, 100 - 16.05, 1.1);
  EXPECT_NEAR(bare.highest_m, 100 + 16.05, 1.1);
  plan.unit = "ft";
  const LoadReport feet = report();
  EXPECT_EQ(feet.elevation[0].unit, "ft");
  EXPECT_FALSE(feet.elevation[0].unit_assumed);
  EXPECT_NEAR(feet.highest_m, bare.highest_m * 0.3048, 0.1);
}

TEST(Limits, CoordinateSystemIsTextAndNeverAFileOrAnAddress) {
  const Folder folder;
  test::RasterPlan plan = test::around(-99.5, 33, hill);
  plan.crs = "";
  WorldSpec spec = test::scene(-99.5, 33, 1500, {test::write_raster(folder, "bare.tif", plan)});
  // A file that does hold a system: what it says is not used.
  const std::string file = folder.text(
      "system.prj",
      R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])");
  for (const std::string& crs : {file, std::string("http://127.0.0.1:9/x.prj"), std::string("/etc/passwd")}) {
    spec.terrain.crs = crs;
    const std::string error = test::error_of(spec);
    EXPECT_NE(error.find("[terrain] crs"), std::string::npos) << error;
    EXPECT_EQ(error.find("connect"), std::string::npos) << error;
  }
  spec.terrain.crs = "EPSG:4326";
  EXPECT_EQ(test::error_of(spec), "no error");
}

std::string error_with(const std::string& source, const std::string& layer = "") {
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].source = source;
  spec.buildings[0].layer = layer;
  return test::error_of(spec);
}

void expect_named(const std::string& error, const std::string& name) {
  EXPECT_NE(error.find("[[buildings]] source"), std::string::npos) << error;
  EXPECT_NE(error.find(name), std::string::npos) << error;
}

TEST(BadBuildings, MissingEmptyAndUnreadableSourcesAreNamed) {
  const Folder folder;
  expect_named(error_with(""), "empty name");
  expect_named(error_with(folder.file("none.gpkg")), "none.gpkg");
  expect_named(error_with(folder.text("empty.geojson", "")), "empty.geojson");
  expect_named(error_with(folder.text("words.geojson", "no outlines here")), "words.geojson");
  const std::string whole =
      test::collection({test::polygon_feature(test::town_frame(), {test::square(0, 0, 10)})});
  expect_named(error_with(folder.text("cut.geojson", whole.substr(0, whole.size() / 2))), "cut.geojson");
  const test::RasterPlan plan = test::around(-99.5, 33, [](double, double) { return 1; });
  expect_named(error_with(test::write_raster(folder, "raster.tif", plan)), "raster.tif");
}

TEST(BadBuildings, UnknownLayerSaysWhichThereAre) {
  const Folder folder;
  const std::string path =
      folder.text("town.geojson",
                  test::collection({test::polygon_feature(test::town_frame(), {test::square(0, 0, 10)})}));
  const std::string error = error_with(path, "houses");
  expect_named(error, "\"houses\"");
  EXPECT_NE(error.find("one of town"), std::string::npos) << error;
}

TEST(BadBuildings, NumbersThatAreNotDegreesNeedACoordinateSystem) {
  const Folder folder;
  expect_named(error_with(folder.text("metres.csv",
                                      "WKT,height\n\"POLYGON((500000 4000000,500010 4000000,"
                                      "500010 4000010,500000 4000000))\",5\n")),
               "no coordinate system");
}

TEST(BadBuildings, NothingIsShownOfATableOfText) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].source = folder.text("other.csv", "root:s3cret:19000,more\nbin:s3cret,more\n");
  spec.buildings[0].height_field = "height";
  const std::string error = test::error_of(spec);
  expect_named(error, "other.csv: its layer has no shapes; allowed: a source of polygons");
  EXPECT_EQ(error.find("s3cret"), std::string::npos) << error;
}

TEST(BadBuildings, DefaultHeightAndUnitAreChecked) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].source = folder.text("a.geojson", test::collection({}));
  for (double wrong : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    spec.buildings[0].default_height_m = wrong;
    EXPECT_NE(test::error_of(spec).find("default_height_m"), std::string::npos) << wrong;
  }
  spec.buildings[0].default_height_m = 8;
  spec.buildings[0].unit = "cubit";
  EXPECT_NE(test::error_of(spec).find("cubit"), std::string::npos);
}

TEST(HeightText, ReadsWhatPeopleWrite) {
  const auto metres = [](const char* text) { return parse_height_m(text, 1).value_or(-1); };
  EXPECT_DOUBLE_EQ(metres("12.5"), 12.5);
  EXPECT_DOUBLE_EQ(metres(" 12,5 m "), 12.5);
  EXPECT_DOUBLE_EQ(metres("12.5m"), 12.5);
  EXPECT_DOUBLE_EQ(metres("40 ft"), 12.192);
  EXPECT_DOUBLE_EQ(metres("40 ft."), 12.192);
  EXPECT_DOUBLE_EQ(metres("40'"), 12.192);
  EXPECT_DOUBLE_EQ(metres("12'6\""), 3.81);
  EXPECT_DOUBLE_EQ(metres("12 ft 6 in"), 3.81);
  EXPECT_DOUBLE_EQ(metres("12' 6''"), 3.81);
  EXPECT_DOUBLE_EQ(metres("3 storeys"), 9);
  EXPECT_DOUBLE_EQ(metres("1.25e+01"), 12.5);
  EXPECT_DOUBLE_EQ(parse_height_m("40", 0.3048).value_or(-1), 12.192);
  EXPECT_DOUBLE_EQ(parse_height_m("40 m", 0.3048).value_or(-1), 40);
}

TEST(HeightText, RefusesWhatIsNoHeight) {
  for (const char* text : {"", " ", "high", "m", "12-15", "1.2.3", "12 parsecs", "12 m 6 in", "12;15", "nan",
                           "inf", "--5", "12 ft 6 ft", "'", "1e", "5 \" 3"}) {
    EXPECT_FALSE(parse_height_m(text, 1).has_value()) << text;
  }
}

}  // namespace
}  // namespace obliq::limits_test
