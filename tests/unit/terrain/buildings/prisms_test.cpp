#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "tests/unit/terrain_outlines.h"

namespace obliq::prisms_test {
namespace {

using test::Folder;

WorldSpec prism_scene(double reach_m = 3000) {
  WorldSpec spec = test::flat_town();
  spec.reaches[0].radius_m = reach_m;
  spec.terrain.cell_m = 50;
  spec.prisms.emplace_back();
  return spec;
}

/// Corner of every building, by identity of its roof.
std::map<std::uint64_t, glm::dvec2> corners(const World& world) {
  std::map<std::uint64_t, glm::dvec2> result;
  const Buildings& b = world.buildings;
  for (const Building& building : b.list) {
    result[b.face(building.first_face).identity] = glm::dvec2(b.ring_xz_m[b.ring_start[building.first_ring]]);
  }
  return result;
}

TEST(RandomPrisms, DensityIsTheAskedOne) {
  const World world = load_world(prism_scene());
  // 36 km2 at 300 a km2, one in each cell: only the border makes a difference, 24 km of it 29 m deep (2 %).
  EXPECT_NEAR(static_cast<double>(world.buildings.list.size()), 36 * 300, 0.03 * 36 * 300);
  EXPECT_EQ(world.report.prisms_placed, world.buildings.list.size());
  EXPECT_EQ(world.report.buildings_outside, 0u);
}

TEST(RandomPrisms, SidesAndHeightsFillTheirRanges) {
  WorldSpec spec = prism_scene();
  spec.prisms[0].width_m = {10, 12};
  spec.prisms[0].length_m = {20, 30};
  spec.prisms[0].height_m = {4, 30};
  const World world = load_world(spec);
  const Buildings& b = world.buildings;
  double least = 1e9, most = 0;
  std::vector<double> bearings;
  for (const Building& building : b.list) {
    const glm::vec2* p = b.ring_xz_m.data() + b.ring_start[building.first_ring];
    const double one = glm::length(glm::dvec2(p[1]) - glm::dvec2(p[0]));
    const double two = glm::length(glm::dvec2(p[2]) - glm::dvec2(p[1]));
    EXPECT_NEAR(glm::dot(glm::dvec2(p[1]) - glm::dvec2(p[0]), glm::dvec2(p[2]) - glm::dvec2(p[1])), 0, 0.05);
    EXPECT_GE(std::min(one, two), 10 - 1e-3);
    EXPECT_LE(std::min(one, two), 12 + 1e-3);
    EXPECT_GE(std::max(one, two), 20 - 1e-3);
    EXPECT_LE(std::max(one, two), 30 + 1e-3);
    least = std::min(least, static_cast<double>(building.roof_y_m));
    most = std::max(most, static_cast<double>(building.roof_y_m));
  }
  EXPECT_NEAR(least, 4, 0.1);
  EXPECT_NEAR(most, 30, 0.1);
}

TEST(RandomPrisms, SameSeedGivesTheSameTownWhateverPartIsLoadedAndAnotherSeedAnother) {
  const auto small = corners(load_world(prism_scene(2000)));
  const auto large = corners(load_world(prism_scene(4000)));
  ASSERT_GT(small.size(), 4000u);
  for (const auto& [identity, corner] : small) {
    const auto found = large.find(identity);
    ASSERT_NE(found, large.end());
    EXPECT_LT(glm::length(found->second - corner), 1e-3);
  }
  WorldSpec other = prism_scene(2000);
  other.prisms[0].seed = 8;
  const auto another = corners(load_world(other));
  for (const auto& [identity, corner] : another) EXPECT_EQ(small.count(identity), 0u);
}

TEST(RandomPrisms, SameTownStandsInTheSamePlaceSeenFromAnotherOrigin) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  const World here = load_world(prism_scene(2000));
  WorldSpec spec = prism_scene(2000);
  spec.origin = spec.reaches[0].centre = {-99.495, 33.004};
  const World there = load_world(spec);
  const auto a = corners(here), b = corners(there);
  std::size_t both = 0;
  for (const auto& [identity, corner] : a) {
    const auto found = b.find(identity);
    if (found == b.end()) continue;
    ++both;
    const WorldPoint origin = here.frame.world_from_geodetic({33.004 * kDegree, -99.495 * kDegree, 0});
    // The two tangent frames are turned by the meridian convergence, 0.0027 degrees: 14 cm over 3 km.
    EXPECT_LT(glm::length(corner - glm::dvec2(origin.m.x, origin.m.z) - found->second), 0.25);
  }
  EXPECT_GT(both, 3000u);
}

TEST(RandomPrisms, StandInsideTheGivenPolygonsAndNotInTheirHoles) {
  const Folder folder;
  const WorldFrame frame = test::town_frame();
  WorldSpec spec = prism_scene();
  spec.prisms[0].within = folder.text(
      "towns.geojson", test::collection({test::polygon_feature(frame, {test::square(-1500, -1500, 2000),
                                                                       test::square(-1000, -1000, 500)}),
                                         test::polygon_feature(frame, {test::square(0, 0, 1000)})}));
  const World world = load_world(spec);
  for (const auto& prism : corners(world)) {
    const glm::dvec2 corner = prism.second;
    const auto in = [&](double x, double z, double side, double slack) {
      return corner.x > x - slack && corner.x < x + side + slack && corner.y > z - slack &&
             corner.y < z + side + slack;
    };
    EXPECT_TRUE(in(-1500, -1500, 2000, 30) || in(0, 0, 1000, 30));
    EXPECT_FALSE(in(-1000, -1000, 500, -30));
  }
  // 4 - 0.25 + 1 km2, of which a quarter of a km2 is in both towns and counts once.
  EXPECT_NEAR(static_cast<double>(world.buildings.list.size()), 4.5 * 300, 0.06 * 4.5 * 300);
}

TEST(RandomPrisms, PolygonOfTheSceneFileBoundsThem) {
  WorldSpec spec = prism_scene();
  spec.prisms[0].within_polygon = {{-99.51, 32.99}, {-99.49, 32.99}, {-99.49, 33.01}, {-99.51, 33.01}};
  const World world = load_world(spec);
  // 0.02 x 93.5 km by 0.02 x 110.9 km.
  EXPECT_NEAR(static_cast<double>(world.buildings.list.size()), 1.869 * 2.218 * 300, 0.03 * 1244);
}

TEST(RandomPrisms, DoNotOverlapWhileTheyFitTheirCells) {
  WorldSpec spec = prism_scene(1500);
  spec.prisms[0].per_km2 = 400;  // 50 m cells
  spec.prisms[0].width_m = {10, 20};
  spec.prisms[0].length_m = {10, 40};
  const World world = load_world(spec);
  const Buildings& b = world.buildings;
  for (std::size_t i = 0; i < b.list.size(); ++i) {
    const glm::dvec3 ci = b.face(b.list[i].first_face).centre_m;
    for (std::size_t j = i + 1; j < b.list.size(); ++j) {
      const glm::dvec3 cj = b.face(b.list[j].first_face).centre_m;
      // Inside the narrower half width of both they would surely overlap.
      ASSERT_GT(glm::length(ci - cj), 10) << i << " " << j;
    }
  }
}

TEST(RandomPrisms, NoneStandAtADensityOfZero) {
  WorldSpec spec = prism_scene();
  spec.prisms[0].per_km2 = 0;
  const World world = load_world(spec);
  EXPECT_EQ(world.buildings.list.size(), 0u);
  EXPECT_EQ(world.report.prisms_placed, 0u);
}

TEST(RandomPrisms, StandOnGroundOnly) {
  const Folder folder;
  test::RasterPlan plan =
      test::around(-99.5, 33, [](double lon, double) { return lon < -99.5 ? 10 : -9999; });
  plan.nodata = -9999;
  WorldSpec spec = test::scene(-99.5, 33, 1500, {test::write_raster(folder, "half.tif", plan)});
  spec.prisms.emplace_back();
  const World world = load_world(spec);
  EXPECT_GT(world.buildings.list.size(), 1000u);
  for (glm::vec2 p : world.buildings.ring_xz_m) EXPECT_LT(p.x, 0);
}

TEST(RandomPrisms, ImpossibleNumbersAndSourcesAreRefusedByKey) {
  const Folder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto error = [&](auto change) {
    WorldSpec spec = prism_scene();
    change(spec.prisms[0]);
    return test::error_of(spec);
  };
  const auto expect = [](const std::string& text, const char* key) {
    EXPECT_NE(text.find(key), std::string::npos) << text;
  };
  expect(error([&](PrismSpec& p) { p.per_km2 = nan; }), "[[prisms]] per_km2");
  expect(error([](PrismSpec& p) { p.per_km2 = -1; }), "[[prisms]] per_km2");
  expect(error([](PrismSpec& p) { p.width_m = {20, 10}; }), "[[prisms]] width_m");
  expect(error([&](PrismSpec& p) { p.length_m = {nan, 10}; }), "[[prisms]] length_m");
  expect(error([](PrismSpec& p) { p.height_m = {-1, 10}; }), "[[prisms]] height_m");
  expect(error([&](PrismSpec& p) { p.within = folder.file("none.geojson"); }), "[[prisms]] within");
  expect(error([&](PrismSpec& p) {
           p.within_polygon = {{nan, 1}, {2, 3}, {4, 5}};
         }),
         "[[prisms]] within_polygon");
  WorldSpec spec = prism_scene(40000);
  spec.prisms[0].per_km2 = 1e5;
  expect(test::error_of(spec), "[[prisms]] per_km2: found more than 8 million");
}

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
}  // namespace obliq::prisms_test
