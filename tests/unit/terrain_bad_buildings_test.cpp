#include <gtest/gtest.h>

#include <limits>

#include "terrain/base/errors.h"
#include "terrain/buildings/height_text.h"
#include "tests/unit/terrain_outlines.h"

namespace obliq {
namespace {

using test::Folder;

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
}  // namespace obliq
