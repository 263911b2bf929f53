#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "terrain/dem/resample.h"
#include "terrain/frames.h"
#include "tests/unit/terrain_files.h"

namespace obliq::synthetic_test {
namespace {

WorldSpec synthetic(SyntheticKind kind, double reach_m = 5000, double cell_m = 25) {
  WorldSpec spec = test::scene(-99.5, 33, reach_m, {});
  spec.terrain.synthetic = kind;
  spec.terrain.cell_m = cell_m;
  return spec;
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
  EXPECT_NE(test::error_of(spec).find("[terrain] cell_m and area"), std::string::npos)
      << test::error_of(spec);
}

TEST(SyntheticTerrain, NumbersThatAreNotUsableAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  WorldSpec spec = synthetic(SyntheticKind::ridge);
  spec.terrain.cell_m = nan;
  EXPECT_NE(test::error_of(spec).find("cell_m"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.terrain.shape.width_m = 0;
  EXPECT_NE(test::error_of(spec).find("width_m"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.reaches[0].radius_m = nan;
  EXPECT_NE(test::error_of(spec).find("reach"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.radius_factor = 0;
  EXPECT_NE(test::error_of(spec).find("radius_factor"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.origin.latitude_deg = nan;
  EXPECT_NE(test::error_of(spec).find("latitude"), std::string::npos);
  spec = synthetic(SyntheticKind::ridge);
  spec.reaches.clear();
  EXPECT_NE(test::error_of(spec).find("[terrain] area"), std::string::npos);
}

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(WorldFrame, RoundTripsWithinAMicrometreUpTo300KilometresFromTheOrigin) {
  for (double factor : {1.0, 4.0 / 3, kInfinity}) {
    const WorldFrame frame(33 * kDegree, -99.5 * kDegree, factor);
    for (double north_deg : {-2.7, 0.0, 2.7}) {
      for (double east_deg : {-3.2, 0.0, 3.2}) {
        const Geodetic there{(33 + north_deg) * kDegree, (-99.5 + east_deg) * kDegree, 1234.5};
        const Geodetic back = frame.geodetic_from_world(frame.world_from_geodetic(there));
        // 1e-6 m over the earth's radius is 1.6e-13 rad.
        EXPECT_NEAR(back.latitude_rad, there.latitude_rad, 1.6e-13);
        EXPECT_NEAR(back.longitude_rad, there.longitude_rad, 1.6e-13);
        EXPECT_NEAR(back.height_m, there.height_m, 1e-6);
      }
    }
  }
}

TEST(WorldFrame, EllipsoidIsExactlyFlatAtInfiniteRadiusFactor) {
  const WorldFrame frame(33 * kDegree, -99.5 * kDegree, kInfinity);
  for (double offset_deg : {0.1, 0.5, 2.0}) {
    const WorldPoint p =
        frame.world_from_geodetic({(33 + offset_deg) * kDegree, (-99.5 - offset_deg) * kDegree, 0});
    // Rounding of ECEF coordinates: 6.4e6 m x 2^-52 is 1.4e-9 m an operation.
    EXPECT_NEAR(p.m.y, 0, 2e-8);
  }
}

TEST(WorldFrame, EllipsoidDropMatchesEcefArithmetic) {
  const WorldFrame frame(61 * kDegree, 10 * kDegree, 1);
  const GeographicLib::Geocentric& earth = GeographicLib::Geocentric::WGS84();
  const double lat = 61, lon = 10;
  double x0, y0, z0, x1, y1, z1;
  earth.Forward(lat, lon, 0, x0, y0, z0);
  earth.Forward(lat + 0.4, lon + 0.9, 0, x1, y1, z1);
  const double dx = x1 - x0, dy = y1 - y0, dz = z1 - z0;
  const double sl = std::sin(lat * kDegree), cl = std::cos(lat * kDegree);
  const double so = std::sin(lon * kDegree), co = std::cos(lon * kDegree);
  const double east = -so * dx + co * dy;
  const double north = -sl * co * dx - sl * so * dy + cl * dz;
  const double up = cl * co * dx + cl * so * dy + sl * dz;
  EXPECT_NEAR(frame.ellipsoid_y_m(east, north), up, 1e-7);
  EXPECT_LT(up, -300);
}

TEST(WorldFrame, MeridianConvergenceIsHalfADegreeAHundredKilometresEastAt33North) {
  const WorldFrame frame(33 * kDegree, -99.5 * kDegree, 4.0 / 3);
  const double east_rad = 100e3 / (6378137.0 * std::cos(33 * kDegree));
  const double north = frame.north_rad({33 * kDegree, -99.5 * kDegree + east_rad, 0});
  // Convergence of meridians on a sphere: d_longitude sin(latitude). North leans back to the origin's
  // meridian.
  EXPECT_NEAR(north, -east_rad * std::sin(33 * kDegree), 2e-5);
  EXPECT_NEAR(std::abs(north) / kDegree, 0.58, 0.01);
}

/// 40 x 30 nodes of 10 m on the plane y = 3 + x/10 - z/20.
HeightGrid plane() {
  HeightGrid grid;
  grid.cell_m = 10;
  grid.nx = 40;
  grid.nz = 30;
  for (int j = 0; j < grid.nz; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      grid.y_m.push_back(static_cast<float>(3 + grid.node_x_m(i) / 10 - grid.node_z_m(j) / 20));
    }
  }
  return grid;
}

void clear(HeightGrid& grid, int i0, int i1, int j0, int j1) {
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
  }
}

TEST(Voids, SmallOnesAreFilledExactlyOnAPlane) {
  const HeightGrid whole = plane();
  HeightGrid grid = plane();
  clear(grid, 10, 14, 10, 14);
  EXPECT_EQ(fill_voids(grid, 50).size(), 25u);
  for (std::size_t n = 0; n < grid.y_m.size(); ++n) ASSERT_NEAR(grid.y_m[n], whole.y_m[n], 1e-5);
}

TEST(Voids, AVoidOneNodeWiderThanAllowedStaysWhole) {
  HeightGrid grid = plane();
  clear(grid, 10, 15, 10, 15);
  EXPECT_TRUE(fill_voids(grid, 50).empty());
  EXPECT_FALSE(grid.node_known(10, 10));
}

TEST(Voids, ALongNarrowGapIsNarrow) {
  HeightGrid grid = plane();
  clear(grid, 2, 37, 10, 11);
  EXPECT_EQ(fill_voids(grid, 20).size(), 72u);
}

TEST(Voids, GroundIsNotInventedBeyondTheBorder) {
  HeightGrid grid = plane();
  clear(grid, 0, 1, 0, 29);
  EXPECT_TRUE(fill_voids(grid, 50).empty());
}

TEST(Voids, ZeroWidthFillsNothing) {
  HeightGrid grid = plane();
  clear(grid, 10, 10, 10, 10);
  EXPECT_TRUE(fill_voids(grid, 0).empty());
}

}  // namespace
}  // namespace obliq::synthetic_test
