// [[surfaces]] gamma_raster: what a raster of decibels says of the ground's cells. Expected values come from
// GeographicLib's own UTM, point by point, not from PROJ and areas.
#include <gtest/gtest.h>

#include <GeographicLib/UTMUPS.hpp>
#include <cmath>
#include <filesystem>
#include <limits>

#include "terrain/base/hash.h"
#include "terrain/dem/pixel_mean.h"
#include "tests/unit/terrain_outlines.h"

namespace obliq::gamma_raster_test {
namespace {

using test::Folder;

constexpr double kRadian_deg = 57.29577951308232;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double power(double db) { return std::pow(10, db / 10); }

/// The raster alone, of all ground.
SurfaceSpec raster(const std::string& file, bool is_gamma = false) {
  SurfaceSpec surface;
  surface.gamma_raster = file;
  surface.raster_is_gamma = is_gamma;
  surface.paints = false;
  return surface;
}

WorldSpec town_with(const std::vector<SurfaceSpec>& surfaces) {
  WorldSpec spec = test::flat_town();
  spec.surfaces = surfaces;
  return spec;
}

/// Easting and northing of a world point of height 0.
glm::dvec2 utm_of(const World& world, double x_m, double z_m) {
  const Geodetic at = world.frame.geodetic_from_world({{x_m, 0, z_m}});
  int zone = 0;
  bool north = false;
  glm::dvec2 place;
  GeographicLib::UTMUPS::Forward(at.latitude_rad * kRadian_deg, at.longitude_rad * kRadian_deg, zone, north,
                                 place.x, place.y, 14);
  return place;
}

/// A raster in UTM, whose pixels' corners lie at multiples of their side; it covers the town and more.
test::RasterPlan utm_plan(double pixel_m, double half_m, std::function<double(double, double)> value_db) {
  const glm::dvec2 middle = utm_of(load_world(test::flat_town()), 0, 0);
  test::RasterPlan plan;
  plan.crs = "EPSG:32614";
  plan.columns = plan.rows = static_cast<int>(2 * half_m / pixel_m);
  const double west = std::floor((middle.x - half_m) / pixel_m) * pixel_m;
  const double top = std::floor((middle.y + half_m) / pixel_m) * pixel_m;
  plan.geotransform = {west, pixel_m, 0, top, 0, -pixel_m};
  plan.value = std::move(value_db);
  return plan;
}

float at(const World& world, double x, double z) {
  return world.raster_gamma_of_cell(static_cast<int>(std::floor((x - world.grid.x0_m) / world.grid.cell_m)),
                                    static_cast<int>(std::floor((z - world.grid.z0_m) / world.grid.cell_m)));
}

/// Mean power under a cell, by 50 x 50 points.
double points_mean(const World& world, int i, int j, const std::function<double(double, double)>& value_db) {
  constexpr int kPoints = 50;
  const double x0 = world.grid.node_x_m(i), z0 = world.grid.node_z_m(j), side = world.grid.cell_m;
  double sum = 0;
  for (int k = 0; k < kPoints; ++k)
    for (int m = 0; m < kPoints; ++m) {
      const glm::dvec2 p = utm_of(world, x0 + (k + 0.5) / kPoints * side, z0 + (m + 0.5) / kPoints * side);
      sum += power(value_db(p.x, p.y));
    }
  return sum / (kPoints * kPoints);
}

TEST(PixelMeans, AreThoseOfPointsInQuadrilateralsOfAnySizeAndTurn) {
  PixelValues pixels;
  pixels.rect = {3, 5, 43, 35};
  for (std::uint64_t k = 0; k < 40 * 30; ++k)
    pixels.value.push_back(k % 7 == 0
                               ? static_cast<float>(kNan)
                               : static_cast<float>(hash_cell(1, static_cast<std::int32_t>(k), 0) % 100));
  for (const double side : {0.3, 1.0, 2.7, 9.0})
    for (const double turn : {0.0, 0.001, 0.5, 0.7853981633974483, 2.0}) {
      const glm::dvec2 u(side * std::cos(turn), side * std::sin(turn));
      const glm::dvec2 v(-0.8 * side * std::sin(turn), 0.8 * side * std::cos(turn));
      const glm::dvec2 first(20.3, 17.1);
      const PixelMean found = mean_under({first, first + u, first + u + v, first + v}, pixels);
      constexpr int kPoints = 1500;
      double sum = 0, known = 0;
      for (int a = 0; a < kPoints; ++a)
        for (int b = 0; b < kPoints; ++b) {
          const glm::dvec2 p = first + u * ((a + 0.5) / kPoints) + v * ((b + 0.5) / kPoints);
          const auto c = static_cast<std::size_t>(std::floor(p.x + 0.5) - 3);
          const auto r = static_cast<std::size_t>(std::floor(p.y + 0.5) - 5);
          const float value = pixels.value[r * 40 + c];
          if (std::isnan(value)) continue;
          sum += static_cast<double>(value);
          ++known;
        }
      // Points beside an edge: a thousandth of the side each way.
      EXPECT_NEAR(found.share, known / kPoints / kPoints, 2e-3) << side << " " << turn;
      EXPECT_NEAR(found.mean, known > 0 ? sum / known : 0, 0.2) << side << " " << turn;
      // The other way round.
      const PixelMean back = mean_under({first, first + v, first + u + v, first + u}, pixels);
      EXPECT_NEAR(back.mean, found.mean, 1e-9);
      EXPECT_NEAR(back.share, found.share, 1e-9);
    }
  EXPECT_EQ(mean_under({glm::dvec2(-9, -9), {-8, -9}, {-8, -8}, {-9, -8}}, pixels).share, 0);
  EXPECT_EQ(mean_under({glm::dvec2(20, 20), {20, 20}, {20, 20}, {20, 20}}, pixels).share, 0);
}

TEST(GammaRaster, WithoutOneNothingIsKept) {
  const Folder folder;
  EXPECT_TRUE(load_world(test::flat_town()).raster_gamma.empty());
  SurfaceSpec lake;
  lake.source =
      folder.text("lake.geojson",
                  test::collection({test::polygon_feature(test::town_frame(), {test::square(0, 0, 200)})}));
  EXPECT_TRUE(load_world(town_with({lake})).raster_gamma.empty());
}

TEST(GammaRaster, ShowsTwoFieldsInAnyCoordinateSystem) {
  const Folder folder;
  // East of the meridian 3 dB more, west of it 7 dB less.
  const auto of_lon = [](double lon, double) { return lon > -99.5 ? 3.0 : -7.0; };
  const World world = load_world(
      town_with({raster(test::write_raster(folder, "fields.tif", test::around(-99.5, 33, of_lon)))}));
  EXPECT_NEAR(at(world, 300, 300), power(3), 1e-6);
  EXPECT_NEAR(at(world, -300, -300), power(-7), 1e-6);
  // The same two fields in UTM and in metres on a transverse Mercator of feet.
  const glm::dvec2 middle = utm_of(world, 0, 0);
  const auto of_easting = [&](double x, double) { return x > middle.x ? 3.0 : -7.0; };
  const World by_utm =
      load_world(town_with({raster(test::write_raster(folder, "utm.tif", utm_plan(30, 1500, of_easting)))}));
  EXPECT_NEAR(at(by_utm, 300, 300), power(3), 1e-6);
  EXPECT_NEAR(at(by_utm, -300, -300), power(-7), 1e-6);
  // Every cell, those on the border too: 1e-3 of the brighter field.
  const World& w = by_utm;
  const double border = std::floor((middle.x - 1500) / 30) * 30;
  const auto of_pixel = [&](double x, double) {
    return of_easting(border + (std::floor((x - border) / 30) + 0.5) * 30, 0);
  };
  for (int j = 0; j < w.grid.nz - 1; j += 7)
    for (int i = 0; i < w.grid.nx - 1; ++i)
      ASSERT_NEAR(w.raster_gamma_of_cell(i, j), points_mean(w, i, j, of_pixel), 0.012 * 2) << i << " " << j;
}

TEST(GammaRaster, FinerThanACellIsAveragedAsPower) {
  const Folder folder;
  const auto noise = [](double x, double y) {
    return -20 + static_cast<double>(hash_cell(4, static_cast<std::int32_t>(std::floor(x / 4)),
                                               static_cast<std::int32_t>(std::floor(y / 4))) %
                                     31);
  };
  const World world =
      load_world(town_with({raster(test::write_raster(folder, "fine.tif", utm_plan(4, 1600, noise)))}));
  double found = 0, expected = 0;
  for (int j = 3; j < world.grid.nz - 1; j += 9)
    for (int i = 2; i < world.grid.nx - 1; i += 9) {
      const double mean = points_mean(world, i, j, noise);
      // 8 points a pixel's side: those on borders are off by a share of the cell's 40 pixels.
      ASSERT_NEAR(world.raster_gamma_of_cell(i, j) / mean, 1, 0.03) << i << " " << j;
      found += static_cast<double>(world.raster_gamma_of_cell(i, j));
      expected += mean;
    }
  EXPECT_NEAR(found / expected, 1, 1e-3);
  // The mean of the decibels, -5, would be 0.32: the named wrong version.
  EXPECT_GT(found / 64, 1.5);
}

TEST(GammaRaster, VoidsKeepTheMaterial) {
  const Folder folder;
  const auto plan = [](std::function<double(double, double)> value) {
    return test::around(-99.5, 33, value);
  };
  test::RasterPlan by_value = plan([](double lon, double) { return lon > -99.5 ? 3.0 : -9999; });
  by_value.nodata = -9999;
  const test::RasterPlan by_nan = plan([](double lon, double) { return lon > -99.5 ? 3.0 : kNan; });
  test::RasterPlan by_mask = plan([](double, double) { return 3.0; });
  by_mask.masked = [](int column, int) { return column < 30; };
  test::RasterPlan by_extent = plan([](double, double) { return 3.0; });
  by_extent.geotransform[0] = -99.5;  // nothing in the west
  test::RasterPlan scaled = plan([](double lon, double) { return lon > -99.5 ? 300 : -32768; });
  scaled.type = "Int16";
  scaled.scale = 0.01;
  scaled.nodata = -32768;
  int n = 0;
  for (const test::RasterPlan& each : {by_value, by_nan, by_mask, by_extent, scaled}) {
    const std::string file = test::write_raster(folder, "voids" + std::to_string(++n) + ".tif", each);
    for (const bool gamma : {false, true}) {
      const World world = load_world(town_with({raster(file, gamma)}));
      EXPECT_NEAR(at(world, 300, 300), gamma ? -power(3) : power(3), 1e-6) << file;
      EXPECT_EQ(at(world, -300, 300), 1) << file;
      EXPECT_TRUE(world.surface_material.empty()) << "frames need not look them up";
    }
  }
}

TEST(GammaRaster, IsOfWhatItsSourcePaintsAndLaterSurfacesLieOverIt) {
  const Folder folder;
  const auto field = [&](const std::string& name, double east, double north, double side) {
    return folder.text(
        name,
        test::collection({test::polygon_feature(test::town_frame(), {test::square(east, north, side)})}));
  };
  const std::string three = test::write_raster(
      folder, "three.tif",
      test::around(-99.5, 33, [](double lon, double) { return lon > -99.5 ? 3.0 : kNan; }));
  SurfaceSpec grass = raster(three);
  grass.source = field("grass.geojson", -400, -400, 800);
  grass.material = 6;
  grass.paints = true;
  SurfaceSpec lake;
  lake.source = field("lake.geojson", 100, 100, 100);
  lake.material = 3;
  const World world = load_world(town_with({grass, lake}));
  EXPECT_NEAR(at(world, 300, 300), power(3), 1e-6);
  EXPECT_EQ(at(world, -300, 300), 1) << "painted, but the raster has no value";
  EXPECT_EQ(world.material_of_cell(40 - 12, 40 + 12), 6);
  EXPECT_EQ(at(world, 600, 600), 1) << "not painted";
  EXPECT_EQ(at(world, 150, 150), 1) << "painted again";
  const World turned = load_world(town_with({lake, grass}));
  EXPECT_NEAR(at(turned, 150, 150), power(3), 1e-6);
  // Without a source, the material goes where the raster has values.
  SurfaceSpec all = raster(three);
  all.material = 6;
  all.paints = true;
  const World bare = load_world(town_with({all}));
  EXPECT_EQ(bare.material_of_cell(60, 40), 6);
  EXPECT_EQ(bare.material_of_cell(20, 40), 0);
}

TEST(GammaRaster, HasTheSameBitsOnAnyNumberOfThreads) {
  const Folder folder;
  const WorldSpec spec = town_with({raster(test::write_raster(
      folder, "noise.tif", utm_plan(7, 1600, [](double x, double y) { return std::fmod(x * y, 17) - 9; })))});
  const World many = load_world(spec);
  World one;
  on_this_thread_alone([&] { one = load_world(spec); });
  EXPECT_EQ(many.raster_gamma, one.raster_gamma);
}

class BadGammaRaster : public testing::Test {
 protected:
  std::string error_of(const test::RasterPlan& plan) {
    return test::error_of(town_with({raster(test::write_raster(folder, "bad.tif", plan))}));
  }
  static test::RasterPlan of(std::function<double(double, double)> value) {
    return test::around(-99.5, 33, std::move(value));
  }
  void expect(const std::string& error, const std::string& part) {
    EXPECT_NE(error.find("[[surfaces]] gamma_raster: found "), std::string::npos) << error;
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }

  Folder folder;
};

TEST_F(BadGammaRaster, OfLinearValuesIsRefusedByItsUnitOrItsValues) {
  // Backscatter of fields and of a town, as linear power: 0.02 to 3.
  const auto linear = [](double lon, double lat) { return lat > 33.004 ? 3 : lon > -99.5 ? 0.2 : 0.02; };
  expect(error_of(of(linear)),
         "bad.tif: values from 0.02 to 3, which are linear: none is negative, most are below 1");
  test::RasterPlan tagged = of([](double lon, double) { return lon > -99.5 ? 3.0 : -7.0; });
  tagged.unit = "linear power";
  expect(error_of(tagged), "bad.tif: its unit is \"linear power\"; allowed: decibels");
  // What says that it is in decibels is believed; so are fields of 0 and +3 dB, and of -0.5.
  tagged = of(linear);
  tagged.unit = "dB";
  EXPECT_EQ(error_of(tagged), "no error");
  EXPECT_EQ(error_of(of([](double lon, double) { return lon > -99.5 ? 3.0 : 0.0; })), "no error");
  EXPECT_EQ(error_of(of([](double lon, double) { return lon > -99.5 ? -0.5 : 0.0; })), "no error");
}

TEST_F(BadGammaRaster, WithoutACoordinateSystemIsRefused) {
  test::RasterPlan plan = of([](double, double) { return -3.0; });
  plan.crs.clear();
  expect(error_of(plan),
         "bad.tif: it carries no coordinate system; allowed: a raster with one (gdal_edit.py");
}

TEST_F(BadGammaRaster, BeyondSixtyDecibelsIsRefused) {
  for (const double value : {-9999.0, 60.5, -61.0, -HUGE_VAL}) {
    // One pixel near the middle: column 31, row 29.
    const auto one = [&](double lon, double lat) {
      return lon > -99.5 && lon < -99.4985 && lat > 33 + 0.5 / 1200 && lat < 33 + 1.5 / 1200 ? value : -3.0;
    };
    const std::string error = error_of(of(one));
    expect(error,
           "in column 31, row 29; allowed: decibels from -60 to 60; voids are told by a nodata value or NaN");
  }
  EXPECT_EQ(error_of(of([](double lon, double) { return lon > -99.5 ? 60.0 : -60.0; })), "no error");
}

TEST_F(BadGammaRaster, ThatIsNoneOrMissingIsRefused) {
  expect(test::error_of(town_with({raster(folder.file("none.tif"))})), "none.tif");
  expect(test::error_of(town_with({raster(folder.text("words.tif", "no raster"))})), "words.tif");
  expect(test::error_of(town_with({raster(folder.text(
             "fields.geojson",
             test::collection({test::polygon_feature(test::town_frame(), {test::square(0, 0, 200)})})))})),
         "it holds vectors only; allowed: a raster");
  const std::string cut = test::write_raster(folder, "cut.tif", of([](double, double) { return -3.0; }));
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) * 6 / 10);
  expect(test::error_of(town_with({raster(cut)})), "cut.tif: rows");
}

TEST(GammaRaster, ElsewhereIsNotedAndChangesNothing) {
  const Folder folder;
  const World world = load_world(town_with({raster(
      test::write_raster(folder, "far.tif", test::around(-90, 40, [](double, double) { return -3.0; })))}));
  EXPECT_EQ(at(world, 300, 300), 1);
  ASSERT_EQ(world.report.notes.size(), 1u);
  EXPECT_NE(world.report.notes[0].find("far.tif: no values in the loaded area"), std::string::npos);
}

}  // namespace
}  // namespace obliq::gamma_raster_test
