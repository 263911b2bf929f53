#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/base/errors.h"
#include "terrain/world.h"

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

WorldSpec synthetic(SyntheticKind kind, double reach_m = 5000, double cell_m = 25) {
  WorldSpec spec;
  spec.terrain.synthetic = kind;
  spec.terrain.cell_m = cell_m;
  spec.radius_factor = kInfinity;
  spec.origin = {-99.5, 33};
  spec.reaches = {{{-99.5, 33}, reach_m}};
  return spec;
}

std::string error_of(const WorldSpec& spec) {
  try {
    load_world(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SyntheticTerrain, FlatGroundIsExactlyZeroOnAFlatEarth) {
  const World world = load_world(synthetic(SyntheticKind::flat));
  EXPECT_EQ(world.grid.nx, 401);
  EXPECT_EQ(world.grid.nz, 401);
  EXPECT_EQ(world.report.posts, 401u * 401u);
  for (float y : world.grid.y_m) ASSERT_EQ(y, 0.0f);
}

TEST(SyntheticTerrain, FlatGroundFallsAwayOnACurvedEarthByTheSquareOverTwiceTheEffectiveRadius) {
  WorldSpec spec = synthetic(SyntheticKind::flat, 40000, 500);
  spec.radius_factor = 4.0 / 3;
  const World world = load_world(spec);
  // Radius of curvature in the meridian at 33 N is 6,354 km and across it 6,385 km.
  EXPECT_NEAR(world.grid.height_at_m(0, 40000), -0.75 * 40000.0 * 40000.0 / (2 * 6354.4e3), 0.05);
  EXPECT_NEAR(world.grid.height_at_m(40000, 0), -0.75 * 40000.0 * 40000.0 / (2 * 6384.5e3), 0.05);
}

TEST(SyntheticTerrain, RampRisesAlongItsBearing) {
  WorldSpec spec = synthetic(SyntheticKind::ramp);
  spec.terrain.shape.slope = 0.1;
  spec.terrain.shape.bearing_deg = 90;
  const World world = load_world(spec);
  EXPECT_NEAR(world.grid.height_at_m(1000, 2000), 100, 1e-4);
  EXPECT_NEAR(world.grid.height_at_m(-1000, -2000), -100, 1e-4);
}

TEST(SyntheticTerrain, RidgeHasItsCrestAtItsDistanceAndItsFeetHalfAWidthAway) {
  WorldSpec spec = synthetic(SyntheticKind::ridge);
  spec.terrain.shape = {.height_m = 300, .base_m = 20, .bearing_deg = 0, .distance_m = 3000, .width_m = 1000};
  const World world = load_world(spec);
  EXPECT_NEAR(world.grid.height_at_m(-2000, 3000), 300, 1e-4);
  EXPECT_NEAR(world.grid.height_at_m(1500, 2750), 160, 1e-4);
  EXPECT_NEAR(world.grid.height_at_m(0, 2500), 20, 1e-4);
  EXPECT_NEAR(world.grid.height_at_m(0, -3000), 20, 1e-4);
}

TEST(SyntheticTerrain, WallStandsFromItsDistanceToItsThicknessBeyondWithFacesOneCellWide) {
  WorldSpec spec = synthetic(SyntheticKind::wall);
  spec.terrain.shape = {.height_m = 50, .bearing_deg = 90, .distance_m = 2000, .width_m = 100};
  const World world = load_world(spec);
  EXPECT_EQ(world.grid.height_at_m(2000, 700), 50);
  EXPECT_EQ(world.grid.height_at_m(2100, 700), 50);
  EXPECT_EQ(world.grid.height_at_m(1975, 700), 0);
  EXPECT_EQ(world.grid.height_at_m(2125, 700), 0);
  EXPECT_EQ(world.grid.height_at_m(-2050, 700), 0);
}

TEST(SyntheticTerrain, ConeFallsFromItsApexToItsBaseRadius) {
  WorldSpec spec = synthetic(SyntheticKind::cone);
  spec.terrain.shape = {.height_m = 100, .bearing_deg = 180, .distance_m = 1000, .width_m = 500};
  const World world = load_world(spec);
  EXPECT_NEAR(world.grid.height_at_m(0, -1000), 100, 1e-4);
  EXPECT_NEAR(world.grid.height_at_m(250, -1000), 50, 1e-4);
  EXPECT_EQ(world.grid.height_at_m(0, -400), 0);
}

TEST(SyntheticTerrain, HillsAreTheSameGroundWhateverPartIsLoaded) {
  WorldSpec small = synthetic(SyntheticKind::hills, 2000);
  WorldSpec large = synthetic(SyntheticKind::hills, 4000);
  const World a = load_world(small);
  const World b = load_world(large);
  int compared = 0;
  for (int j = 0; j < a.grid.nz; ++j) {
    for (int i = 0; i < a.grid.nx; ++i, ++compared) {
      ASSERT_EQ(a.grid.node_y_m(i, j), b.grid.height_at_m(a.grid.node_x_m(i), a.grid.node_z_m(j)));
    }
  }
  EXPECT_EQ(compared, 161 * 161);
}

TEST(SyntheticTerrain, HillsFollowTheirSeedAndStayWithinTheirRelief) {
  WorldSpec spec = synthetic(SyntheticKind::hills, 40000, 200);
  spec.terrain.shape.height_m = 500;
  spec.terrain.shape.base_m = 10;
  const World one = load_world(spec);
  spec.terrain.shape.seed = 2;
  const World two = load_world(spec);
  EXPECT_NE(one.grid.y_m, two.grid.y_m);
  const auto [low, high] = std::minmax_element(one.grid.y_m.begin(), one.grid.y_m.end());
  EXPECT_GE(*low, 10);
  EXPECT_LE(*high, 510);
  EXPECT_GT(*high - *low, 300);
}

TEST(SyntheticTerrain, NodesAreMultiplesOfTheCellAndTheCellIsAMultipleOfTheQuantum) {
  WorldSpec spec = synthetic(SyntheticKind::flat);
  spec.terrain.cell_m.reset();
  spec.sampling_footprint_m = 7.3;
  const World world = load_world(spec);
  EXPECT_EQ(world.grid.cell_m, 234.0 / 32);
  EXPECT_EQ(std::remainder(world.grid.x0_m, world.grid.cell_m), 0);
  spec.sampling_footprint_m = 0;
  EXPECT_EQ(load_world(spec).grid.cell_m, 30);
  spec.sampling_footprint_m = 0.01;
  spec.reaches[0].radius_m = 50;
  EXPECT_EQ(load_world(spec).grid.cell_m, 1);
}

TEST(SyntheticTerrain, AreaPolygonLeavesGroundInsideItOnly) {
  WorldSpec spec = synthetic(SyntheticKind::flat);
  spec.terrain.area = {{-99.55, 32.95}, {-99.45, 32.95}, {-99.45, 33.05}};
  const World world = load_world(spec);
  EXPECT_EQ(world.grid.height_at_m(2000, -2000), 0);
  EXPECT_TRUE(std::isnan(world.grid.height_at_m(-2000, 2000)));
  EXPECT_NEAR(static_cast<double>(world.report.posts_absent) / static_cast<double>(world.report.posts), 0.5,
              0.01);
}

TEST(SyntheticTerrain, TooManyNodesAreRefusedByNameOfTheKeys) {
  WorldSpec spec = synthetic(SyntheticKind::flat, 50000, 1);
  EXPECT_NE(error_of(spec).find("[terrain] cell_m and area"), std::string::npos) << error_of(spec);
}

TEST(SyntheticTerrain, NumbersThatAreNotUsableAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  WorldSpec spec = synthetic(SyntheticKind::ridge);
  spec.terrain.cell_m = nan;
  EXPECT_NE(error_of(spec).find("cell_m"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.terrain.shape.width_m = 0;
  EXPECT_NE(error_of(spec).find("width_m"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.reaches[0].radius_m = nan;
  EXPECT_NE(error_of(spec).find("reach"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.radius_factor = 0;
  EXPECT_NE(error_of(spec).find("radius_factor"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.origin.latitude_deg = nan;
  EXPECT_NE(error_of(spec).find("latitude"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.reaches.clear();
  EXPECT_NE(error_of(spec).find("[terrain] area"), std::string::npos);
}

}  // namespace
}  // namespace obliq
