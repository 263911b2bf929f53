#include "terrain/buildings/building_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>

#include "tests/unit/terrain_outlines.h"

namespace obliq::building_mesh_test {
namespace {

using test::Folder;
using test::polygon_feature;
using test::square;
using test::town;
using test::town_frame;

/// Corners are rounded to float32 (0.03 mm at 500 m): 1e-3 m2 on the 100 m perimeter of a small house.
constexpr double kArea_m2 = 2e-2;

const test::MetreRing kL = {{0, 0}, {30, 0}, {30, 10}, {10, 10}, {10, 40}, {0, 40}};  // 600 m2, concave

TEST(Buildings, ASquareHouseIsARoofAndFourWallsWithNormalsOutwards) {
  const Folder folder;
  const World world =
      town(folder, {polygon_feature(town_frame(), {square(100, 200, 20)}, R"("height":12.5)")});
  const Buildings& b = world.buildings;
  ASSERT_EQ(b.list.size(), 1u);
  EXPECT_EQ(b.building_of_face.size(), 5u);
  EXPECT_FALSE(b.face(0).wall);
  EXPECT_TRUE(b.face(4).wall);
  const BuildingMesh mesh = mesh_of(b);
  EXPECT_EQ(mesh.triangles.size(), 2u + 4u * 2u);
  EXPECT_EQ(mesh.triangle_face.size(), mesh.triangles.size());
  EXPECT_FLOAT_EQ(b.list[0].roof_y_m, 12.5f);
  EXPECT_LT(b.list[0].base_y_m, 0);
  const double height = static_cast<double>(b.list[0].roof_y_m) - static_cast<double>(b.list[0].base_y_m);
  EXPECT_NEAR(test::enclosed_volume_m3(b, 0), 400 * height, 400 * 1e-3);
  EXPECT_NEAR(b.face(0).centre_m.x, 110, 1e-3);
  EXPECT_NEAR(b.face(0).centre_m.z, 210, 1e-3);
  EXPECT_NEAR(b.face(0).centre_m.y, 12.5, 1e-5);
  EXPECT_NEAR(b.face(1).centre_m.y, 6.25, 1e-3);
  EXPECT_EQ(world.report.buildings_kept, 1u);
  EXPECT_EQ(world.report.buildings_default_height, 0u);
}

TEST(Buildings, EveryTriangleFacesAwayFromTheInside) {
  const Folder folder;
  const World world = town(folder, {polygon_feature(town_frame(), {square(-50, -50, 30)})});
  const Buildings& b = world.buildings;
  const glm::dvec3 inside(-35, 2, -35);
  const BuildingMesh mesh = mesh_of(b);
  for (glm::uvec3 t : mesh.triangles) {
    const glm::dvec3 p(mesh.vertices_m[t.x]), q(mesh.vertices_m[t.y]), r(mesh.vertices_m[t.z]);
    EXPECT_GT(glm::dot(glm::cross(q - p, r - p), (p + q + r) / 3.0 - inside), 0);
  }
}

TEST(Buildings, ConcaveOutlinesWithHolesKeepTheirArea) {
  const Folder folder;
  const test::MetreRing court = {{2, 2}, {8, 2}, {8, 30}, {2, 30}};  // 168 m2, counter-clockwise on purpose
  const World world = town(folder, {polygon_feature(town_frame(), {kL, court}, R"("height":9)")});
  const Buildings& b = world.buildings;
  ASSERT_EQ(b.list.size(), 1u);
  EXPECT_EQ(b.list[0].n_rings, 2u);
  EXPECT_EQ(b.list[0].n_faces, 1u + 6u + 4u);
  EXPECT_NEAR(test::roof_area_m2(b, 0), 600 - 168, kArea_m2);
  const double height = static_cast<double>(b.list[0].roof_y_m) - static_cast<double>(b.list[0].base_y_m);
  EXPECT_NEAR(test::enclosed_volume_m3(b, 0), (600 - 168) * height, kArea_m2 * height);
}

TEST(Buildings, OutlinesRunCounterClockwiseAndHolesClockwiseWhateverTheSource) {
  const Folder folder;
  test::MetreRing backwards(kL.rbegin(), kL.rend());
  const World world = town(folder, {polygon_feature(town_frame(), {backwards, {{2, 2}, {8, 2}, {8, 30}}})});
  const Buildings& b = world.buildings;
  for (std::size_t r = 0; r + 1 < b.ring_start.size(); ++r) {
    double twice = 0;
    for (std::uint32_t k = b.ring_start[r]; k < b.ring_start[r + 1]; ++k) {
      const std::uint32_t next = k + 1 < b.ring_start[r + 1] ? k + 1 : b.ring_start[r];
      const glm::dvec2 p(b.ring_xz_m[k]), q(b.ring_xz_m[next]);
      twice += p.x * q.y - q.x * p.y;
    }
    EXPECT_EQ(twice > 0, r == 0);
  }
}

TEST(Buildings, RingsAreExactlyTheMeshesCorners) {
  const Folder folder;
  const World world = town(folder, {polygon_feature(town_frame(), {kL})});
  const Buildings& b = world.buildings;
  const BuildingMesh mesh = mesh_of(b);
  for (std::size_t k = 0; k < b.ring_xz_m.size(); ++k) {
    EXPECT_EQ(mesh.vertices_m[k].x, b.ring_xz_m[k].x);
    EXPECT_EQ(mesh.vertices_m[k].z, b.ring_xz_m[k].y);
  }
}

TEST(Buildings, MeshAndFacesHaveTheSameTriangles) {
  const Folder folder;
  const test::MetreRing court = {{2, 2}, {8, 2}, {8, 30}, {2, 30}};
  const World world = town(folder, {polygon_feature(town_frame(), {kL, court}),
                                    polygon_feature(town_frame(), {square(100, 100, 20)}),
                                    polygon_feature(town_frame(), {{{60, 0}, {90, 0}, {70, 5}, {60, 40}}})});
  Buildings b = world.buildings;
  for (const bool walls : {true, false}) {
    b.walls = walls;
    const BuildingMesh mesh = mesh_of(b);
    ASSERT_EQ(mesh.triangles.size(), triangle_count(b));
    std::size_t k = 0;
    std::uint32_t number = 0;
    for (const Building& building : b.list) {
      for_each_triangle(b, building, [&](std::uint32_t face, const Triangle& triangle) {
        ASSERT_LT(k, mesh.triangles.size());
        EXPECT_EQ(mesh.triangle_face[k], face);
        number = k > 0 && mesh.triangle_face[k - 1] == face ? number + 1 : 0;
        EXPECT_EQ(triangle_of(b, face, number), triangle);
        for (int c = 0; c < 3; ++c)
          EXPECT_EQ(mesh.vertices_m[mesh.triangles[k][c]], triangle[static_cast<std::size_t>(c)]);
        EXPECT_TRUE(walls || !b.face(face).wall);
        ++k;
      });
    }
    EXPECT_EQ(k, mesh.triangles.size());
  }
}

TEST(Buildings, MultipolygonsAndClosedLinesArePrisms) {
  const Folder folder;
  const WorldFrame frame = town_frame();
  const std::string a = test::coordinates(frame, {square(0, 0, 10)});
  const std::string b = test::coordinates(frame, {square(50, 0, 10)});
  const std::string c = test::coordinates(frame, {square(100, 0, 10)});
  const World world = town(folder, {test::feature("MultiPolygon", "[" + a + "," + b + "]", R"("height":7)"),
                                    test::feature("LineString", c.substr(1, c.size() - 2), R"("height":7)")});
  EXPECT_EQ(world.report.buildings_read, 2u);
  EXPECT_EQ(world.report.buildings_kept, 3u);
  EXPECT_EQ(world.buildings.list.size(), 3u);
}

TEST(Buildings, HeightComesFromTheFieldThenHeightThenLevelsThenTheDefault) {
  const Folder folder;
  const WorldFrame frame = town_frame();
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].height_field = "tall";
  spec.buildings[0].unit = "ft";
  spec.buildings[0].default_height_m = 5;
  const World world = town(folder,
                           {polygon_feature(frame, {square(0, 0, 10)}, R"("tall":100,"height":9)"),
                            polygon_feature(frame, {square(20, 0, 10)}, R"("tall":"12 m","height":9)"),
                            polygon_feature(frame, {square(40, 0, 10)}, R"("height":9,"building:levels":7)"),
                            polygon_feature(frame, {square(60, 0, 10)}, R"("building:levels":"4")"),
                            polygon_feature(frame, {square(80, 0, 10)}, R"("tall":-3,"height":"high")"),
                            polygon_feature(frame, {square(100, 0, 10)})},
                           spec);
  ASSERT_EQ(world.buildings.list.size(), 6u);
  const float expected[] = {30.48f, 12, 9, 12, 5, 5};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_FLOAT_EQ(world.buildings.list[k].roof_y_m, expected[k]) << k;
  EXPECT_EQ(world.report.buildings_default_height, 2u);
}

TEST(Buildings, MissingHeightFieldIsWarnedOf) {
  const Folder folder;
  const World world = town(folder, {polygon_feature(town_frame(), {square(0, 0, 10)})});
  ASSERT_EQ(world.report.warnings.size(), 1u);
  EXPECT_NE(world.report.warnings[0].find("\"height\""), std::string::npos);
}

TEST(Buildings, SelfIntersectingOutlinesAreRepairedAndCounted) {
  const Folder folder;
  const test::MetreRing bow = {{0, 0}, {20, 20}, {20, 0}, {0, 20}};  // two triangles of 100 m2
  const World world = town(folder, {polygon_feature(town_frame(), {bow})});
  EXPECT_EQ(world.report.buildings_repaired, 1u);
  ASSERT_EQ(world.buildings.list.size(), 2u);
  EXPECT_NEAR(test::roof_area_m2(world.buildings, 0) + test::roof_area_m2(world.buildings, 1), 200, kArea_m2);
  EXPECT_GT(test::enclosed_volume_m3(world.buildings, 0), 0);
  EXPECT_GT(test::enclosed_volume_m3(world.buildings, 1), 0);
}

TEST(Buildings, ZeroAreaDuplicateOutsideAndUnusableOnesAreSkippedAndCounted) {
  const Folder folder;
  const WorldFrame frame = town_frame();
  test::MetreRing turned = {{20, 20}, {0, 20}, {0, 0}, {20, 0}};
  test::MetreRing reversed(turned.rbegin(), turned.rend());
  const World world = town(
      folder, {polygon_feature(frame, {square(0, 0, 20)}), polygon_feature(frame, {turned}),
               polygon_feature(frame, {reversed}), polygon_feature(frame, {{{50, 50}, {60, 60}, {70, 70}}}),
               polygon_feature(frame, {{{80, 80}, {80, 80}, {80, 80}}}),
               polygon_feature(frame, {square(5000, 0, 20)}), polygon_feature(frame, {square(990, 0, 20)}),
               test::feature("Point", "[-99.5,33]"), R"({"type":"Feature","properties":{},"geometry":null})",
               test::feature("Polygon", "[[[-99.5,33],[-99.5,33]]]")});
  EXPECT_EQ(world.report.buildings_read, 10u);
  EXPECT_EQ(world.report.buildings_kept, 1u);
  EXPECT_EQ(world.report.buildings_duplicate, 2u);
  EXPECT_EQ(world.report.buildings_zero_area, 1u);
  EXPECT_EQ(world.report.buildings_outside, 2u);
  EXPECT_EQ(world.report.buildings_unusable, 4u);  // one point thrice is not a ring
}

TEST(Buildings, CoordinatesThatAreNotNumbersAreSkippedAndCounted) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].source = folder.text("odd.csv",
                                         "WKT,height\n"
                                         "\"POLYGON((-99.5 33,-99.4999 33,-99.4999 33.0001,-99.5 33))\",5\n"
                                         "\"POLYGON((-99.5 33,nan 33,-99.4999 33.0001,-99.5 33))\",5\n"
                                         "\"POLYGON((-99.5 33,-99.4999 inf,-99.4999 33.0001,-99.5 33))\",5\n"
                                         "\"POLYGON EMPTY\",5\n");
  const World world = load_world(spec);
  EXPECT_EQ(world.report.buildings_kept, 1u);
  EXPECT_EQ(world.report.buildings_unusable, 3u);
}

TEST(Buildings, WithoutGroundTheyAreSkippedAndCounted) {
  const Folder folder;
  test::RasterPlan plan =
      test::around(-99.5, 33, [](double lon, double) { return lon < -99.5 ? 10 : -9999; });
  plan.nodata = -9999;
  WorldSpec spec = test::scene(-99.5, 33, 1000, {test::write_raster(folder, "half.tif", plan)});
  const World world = town(folder,
                           {polygon_feature(town_frame(), {square(-300, 0, 20)}),
                            polygon_feature(town_frame(), {square(500, 0, 20)})},
                           spec);
  EXPECT_EQ(world.report.buildings_kept, 1u);
  EXPECT_EQ(world.report.buildings_no_ground, 1u);
}

TEST(Buildings, AreaPolygonKeepsWhatIsInsideIt) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  spec.terrain.area = {{-99.51, 32.99}, {-99.5, 32.99}, {-99.5, 33.01}, {-99.51, 33.01}};
  const World world = town(folder,
                           {polygon_feature(town_frame(), {square(-300, 0, 20)}),
                            polygon_feature(town_frame(), {square(-10, 0, 20)})},
                           spec);
  EXPECT_EQ(world.report.buildings_kept, 1u);
  EXPECT_EQ(world.report.buildings_outside, 1u);
}

TEST(Buildings, NoneFloatsOnRoughGroundAndRoofsStandOnTheMeanOfTheCorners) {
  const Folder folder;
  WorldSpec spec = test::flat_town();
  spec.terrain.synthetic = SyntheticKind::hills;
  spec.terrain.shape.height_m = 2000;
  std::vector<std::string> features;
  for (int k = 0; k < 40; ++k) {
    test::MetreRing ring;
    for (glm::dvec2 p : kL) ring.push_back(p * (1.0 + 0.1 * k) + glm::dvec2(-900 + 40 * k, -800 + 35 * k));
    features.push_back(polygon_feature(town_frame(), {ring}, R"("height":6)"));
  }
  const World world = town(folder, features, spec);
  const Buildings& b = world.buildings;
  ASSERT_EQ(b.list.size(), 40u);
  for (const Building& building : b.list) {
    const std::uint32_t from = b.ring_start[building.first_ring], to = b.ring_start[building.first_ring + 1];
    double mean = 0;
    glm::dvec2 low(1e9), high(-1e9);
    for (std::uint32_t k = from; k < to; ++k) {
      const glm::dvec2 p(b.ring_xz_m[k]);
      mean += world.grid.height_at_m(p.x, p.y) / (to - from);
      low = glm::dvec2(std::min(low.x, p.x), std::min(low.y, p.y));
      high = glm::dvec2(std::max(high.x, p.x), std::max(high.y, p.y));
    }
    EXPECT_NEAR(static_cast<double>(building.roof_y_m), mean + 6, 1e-3);
    // A metre's mesh over the outline's rectangle holds points near every node, edge and diagonal under it.
    for (double x = low.x; x <= high.x; x += 1) {
      for (double z = low.y; z <= high.y; z += 1) {
        ASSERT_LT(static_cast<double>(building.base_y_m), world.grid.height_at_m(x, z));
      }
    }
  }
}

TEST(Buildings, OutlinesInAProjectedSystemStandWhereTheirDegreesSay) {
  const Folder folder;
  // echo -99.499 33.001 | gdaltransform -s_srs EPSG:4269 -t_srs EPSG:26914 and so on for the other corners.
  WorldSpec spec = test::flat_town();
  spec.buildings.emplace_back();
  spec.buildings[0].source = folder.text(
      "utm.geojson",
      test::collection(
          {test::feature("Polygon",
                         "[[[453291.840167944,3651397.94452688],[453391.840167944,3651397.94452688],"
                         "[453391.840167944,3651497.94452688],[453291.840167944,3651397.94452688]]]")},
          "urn:ogc:def:crs:EPSG::26914"));
  const World world = load_world(spec);
  ASSERT_EQ(world.buildings.list.size(), 1u);
  double nearest = 1e9;
  for (glm::vec2 p : world.buildings.ring_xz_m) nearest = std::min(nearest, glm::length(glm::dvec2(p)));
  EXPECT_LT(nearest, 1e-3);  // the first corner is the scene's origin
  EXPECT_NEAR(test::roof_area_m2(world.buildings, 0), 5000, 5000 * 1e-3);  // UTM's scale is within 0.04 %
}

TEST(Buildings, FarAwayOnHighGroundCornersFollowThePlumbLine) {
  const Folder folder;
  constexpr double kDegree = std::numbers::pi / 180;
  test::RasterPlan plan = test::around(-99.1, 33.0, [](double, double) { return 3000; });
  WorldSpec spec = test::scene(-99.5, 33, 40000, {test::write_raster(folder, "plateau.tif", plan)});
  spec.terrain.cell_m = 50;
  spec.buildings.emplace_back();
  spec.buildings[0].source = folder.text(
      "house.geojson", test::collection({test::feature(
                           "Polygon", "[[[-99.1,33],[-99.0998,33],[-99.0998,33.0002],[-99.1,33]]]")}));
  const World world = load_world(spec);
  ASSERT_EQ(world.buildings.list.size(), 1u);
  const WorldPoint corner = world.frame.world_from_geodetic({33 * kDegree, -99.1 * kDegree, 3000});
  double nearest = 1e9;
  for (glm::vec2 p : world.buildings.ring_xz_m) {
    nearest = std::min(nearest, glm::length(glm::dvec2(p) - glm::dvec2(corner.m.x, corner.m.z)));
  }
  EXPECT_LT(nearest, 0.01);  // float32 steps are 4 mm here; without the plumb line it would be 17 m
}

TEST(Buildings, FacesKeepTheirIdentityWhateverElseIsLoaded) {
  const Folder folder;
  const std::string house = polygon_feature(town_frame(), {kL}, R"("height":9)");
  const World alone = town(folder, {house});
  WorldSpec wide = test::flat_town();
  wide.reaches[0].radius_m = 1500;
  const World among = town(folder, {polygon_feature(town_frame(), {square(300, 0, 10)}), house}, wide);
  ASSERT_EQ(among.buildings.list.size(), 2u);
  const std::uint32_t first = among.buildings.list[1].first_face;
  std::set<std::uint64_t> different;
  for (std::uint32_t k = 0; k < alone.buildings.building_of_face.size(); ++k) {
    EXPECT_EQ(alone.buildings.face(k).identity, among.buildings.face(first + k).identity);
    different.insert(alone.buildings.face(k).identity);
  }
  EXPECT_EQ(different.size(), alone.buildings.building_of_face.size());
}

}  // namespace
}  // namespace obliq::building_mesh_test
