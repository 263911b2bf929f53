#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/unit/terrain_outlines.h"

namespace obliq {
namespace {

using test::Folder;
using test::polygon_feature;
using test::square;

SurfaceSpec painted(const std::string& source, std::uint8_t material) {
  SurfaceSpec surface;
  surface.source = source;
  surface.material = material;
  return surface;
}

/// Material of the cell that holds (x, z).
int at(const World& world, double x, double z) {
  return world.material_of_cell(static_cast<int>(std::floor((x - world.grid.x0_m) / world.grid.cell_m)),
                                static_cast<int>(std::floor((z - world.grid.z0_m) / world.grid.cell_m)));
}

TEST(Surfaces, WithoutAnyAllGroundIsMaterialZero) {
  const World world = load_world(test::flat_town());
  EXPECT_TRUE(world.surface_material.empty());
  EXPECT_EQ(at(world, 100, 100), 0);
}

TEST(Surfaces, CellsTakeTheMaterialAtTheirCentreAndLaterSurfacesWin) {
  const Folder folder;
  const WorldFrame frame = test::town_frame();
  WorldSpec spec = test::flat_town();
  spec.surfaces = {
      painted(folder.text("lake.geojson", test::collection({polygon_feature(
                                              frame, {square(-500, -500, 800), square(-300, -300, 200)})})),
              3),
      painted(folder.text("town.geojson", test::collection({polygon_feature(frame, {square(0, 0, 400)})})),
              5)};
  const World world = load_world(spec);
  for (int j = 0; j < world.grid.nz - 1; ++j) {
    for (int i = 0; i < world.grid.nx - 1; ++i) {
      const double x = world.grid.node_x_m(i) + 12.5, z = world.grid.node_z_m(j) + 12.5;
      const auto in = [&](double from, double to) { return x > from && x < to && z > from && z < to; };
      const int expected = in(0, 400) ? 5 : in(-500, 300) && !in(-300, -100) ? 3 : 0;
      ASSERT_EQ(world.material_of_cell(i, j), expected) << x << " " << z;
    }
  }
}

TEST(Surfaces, AttributeFilterChoosesFeatures) {
  const Folder folder;
  const WorldFrame frame = test::town_frame();
  WorldSpec spec = test::flat_town();
  spec.surfaces = {painted(
      folder.text("land.geojson",
                  test::collection({polygon_feature(frame, {square(0, 0, 200)}, R"("use":"water")"),
                                    polygon_feature(frame, {square(-400, 0, 200)}, R"("use":"wood")")})),
      2)};
  spec.surfaces[0].where = "use = 'water'";
  const World world = load_world(spec);
  EXPECT_EQ(at(world, 100, 100), 2);
  EXPECT_EQ(at(world, -300, 100), 0);
  spec.surfaces[0].where = "use === water";
  const std::string error = test::error_of(spec);
  EXPECT_NE(error.find("[[surfaces]] source"), std::string::npos) << error;
  EXPECT_NE(error.find("use === water"), std::string::npos) << error;
}

TEST(Surfaces, SchemePaintsEveryClassAndSaysHowManyCellsHaveNone) {
  const Folder folder;
  test::RasterPlan plan =
      test::around(-99.5, 33, [](double lon, double lat) { return lon > -99.5 ? lat > 33 ? 11 : 12 : 82; });
  plan.type = "Byte";
  WorldSpec spec = test::flat_town();
  spec.surfaces.emplace_back();
  spec.surfaces[0].source = test::write_raster(folder, "cover.tif", plan);
  spec.surfaces[0].scheme = "nlcd";
  spec.surfaces[0].scheme_materials = {{11, 3}, {82, 2}, {41, 5}};
  const World world = load_world(spec);
  EXPECT_EQ(at(world, 500, 500), 3);
  EXPECT_EQ(at(world, -500, 500), 2);
  EXPECT_EQ(at(world, 500, -500), 0) << "class 12 has no material and stays";
  ASSERT_EQ(world.report.notes.size(), 1u);
  const std::string& note = world.report.notes[0];
  // A quarter of 80 x 80 cells, but for those along the two borders of its pixels.
  EXPECT_NEAR(std::stod(note.substr(note.find(".tif: ") + 6)), 1600, 160) << note;
  EXPECT_NE(note.find("without a material in the scheme \"nlcd\" (12)"), std::string::npos) << note;
}

TEST(Surfaces, ClassRasterPaintsThePixelsOfItsClasses) {
  const Folder folder;
  test::RasterPlan plan =
      test::around(-99.5, 33, [](double lon, double lat) { return lon > -99.5 ? lat > 33 ? 11 : 21 : 95; });
  plan.type = "Byte";
  WorldSpec spec = test::flat_town();
  spec.surfaces = {painted(test::write_raster(folder, "classes.tif", plan), 4)};
  spec.surfaces[0].classes = {11, 95};
  const World world = load_world(spec);
  EXPECT_EQ(at(world, 500, 500), 4);
  EXPECT_EQ(at(world, 500, -500), 0);
  EXPECT_EQ(at(world, -500, 500), 4);
  EXPECT_EQ(at(world, -500, -500), 4);
}

TEST(Surfaces, ClassRasterFollowsThePlumbLineOnHighGround) {
  const Folder folder;
  // 37 km east on 3 km of height, world x leans 17 m from the plumb line: a border seen there tells.
  const double border = -99.1;
  test::RasterPlan high = test::around(border, 33.0, [](double, double) { return 3000; });
  test::RasterPlan classes =
      test::around(border, 33.0, [&](double lon, double) { return lon < border ? 1 : 2; });
  classes.geotransform[0] = border - 30.0 / 1200;  // a pixel's edge on the border
  classes.type = "Byte";
  WorldSpec spec = test::scene(-99.5, 33, 40000, {test::write_raster(folder, "high.tif", high)});
  spec.terrain.cell_m = 2;
  spec.terrain.area = {{-99.105, 32.998}, {-99.095, 32.998}, {-99.095, 33.002}, {-99.105, 33.002}};
  spec.surfaces = {painted(test::write_raster(folder, "classes.tif", classes), 9)};
  spec.surfaces[0].classes = {2};
  const World world = load_world(spec);
  constexpr double kDegree = 3.14159265358979323846 / 180;
  const WorldPoint edge = world.frame.world_from_geodetic({33 * kDegree, border * kDegree, 3000});
  EXPECT_EQ(at(world, edge.m.x - 3, edge.m.z), 0);
  EXPECT_EQ(at(world, edge.m.x + 3, edge.m.z), 9);
}

TEST(Surfaces, BadSourcesAreNamed) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  const auto expect = [&](const std::string& name) {
    const std::string error = test::error_of(spec);
    EXPECT_NE(error.find("[[surfaces]] source"), std::string::npos) << error;
    EXPECT_NE(error.find(name), std::string::npos) << error;
  };
  spec.surfaces = {painted(folder.file("none.geojson"), 1)};
  expect("none.geojson");
  spec.surfaces[0].classes = {1};
  expect("none.geojson");
  test::RasterPlan plan = test::around(-99.5, 33, [](double, double) { return 1; });
  plan.type = "Byte";
  spec.surfaces[0].source = test::write_raster(folder, "classes.tif", plan);
  EXPECT_EQ(test::error_of(spec), "no error");
  std::filesystem::resize_file(spec.surfaces[0].source,
                               std::filesystem::file_size(spec.surfaces[0].source) * 6 / 10);
  expect("classes.tif");
  spec.surfaces[0].classes.clear();
  expect("classes.tif: it holds a raster only; allowed: polygons, or a class raster with its classes named");
}

}  // namespace
}  // namespace obliq
