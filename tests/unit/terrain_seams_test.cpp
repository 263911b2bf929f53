// Elevation models that adjoin: each ends at its own last posts, the ground goes on.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

using test::Folder;
using test::RasterPlan;

constexpr double kLon = -99.5;
constexpr double kLat = 33;
constexpr double kPost_m = 30;
constexpr double kVoid = -9999;

// echo -99.5 33 | gdaltransform -s_srs EPSG:4269 -t_srs EPSG:26914
constexpr double kEast_m = 453291.840167944;
constexpr double kNorth_m = 3651397.94452688;

double plane(double x, double y) { return 100 + 0.1 * (x - kEast_m) + 0.05 * (y - kNorth_m); }

/// Posts of one lattice, point raster, void where the quad does not reach.
template <class Has>
RasterPlan quad(Has has) {
  RasterPlan plan;
  plan.crs = "EPSG:26914";
  plan.columns = plan.rows = 101;
  plan.geotransform = {kEast_m - 50.5 * kPost_m, kPost_m, 0, kNorth_m + 50.5 * kPost_m, 0, -kPost_m};
  plan.point = true;
  plan.nodata = kVoid;
  plan.value = [has](double x, double y) {
    const long column = std::lround((x - kEast_m) / kPost_m);
    const long row = std::lround((y - kNorth_m) / kPost_m);
    return has(column, row) ? plane(x, y) : kVoid;
  };
  return plan;
}

/// The quads' common edge leans: one posting sideways for every six.
long edge(long row) { return static_cast<long>(std::floor(static_cast<double>(row) / 6)); }

WorldSpec two_quads(const Folder& folder, bool feet = false) {
  const auto hole = [](long c, long r) { return std::abs(c - 20) <= 4 && std::abs(r) <= 4; };
  RasterPlan west = quad([](long c, long r) { return c <= edge(r); });
  RasterPlan east = quad([hole](long c, long r) { return c > edge(r) && !hole(c, r); });
  if (feet) {
    east.unit = "ft";
    east.value = [metres = east.value](double x, double y) {
      const double value = metres(x, y);
      return value == kVoid ? kVoid : value / 0.3048;
    };
  }
  WorldSpec spec = test::scene(
      kLon, kLat, 1000, {write_raster(folder, "west.tif", west), write_raster(folder, "east.tif", east)});
  spec.terrain.cell_m = 10;
  spec.terrain.fill_void_m = 0;
  return spec;
}

/// The same plane from one file that has all posts.
World whole(const Folder& folder) {
  WorldSpec spec = test::scene(kLon, kLat, 1000,
                               {write_raster(folder, "whole.tif", quad([](long, long) { return true; }))});
  spec.terrain.cell_m = 10;
  return load_world(spec);
}

TEST(Seams, QuadsWhoseLastPostsAreOnePostingApartGiveTheGroundOfOneFile) {
  const Folder folder;
  const World one = whole(folder);
  for (bool feet : {false, true}) {
    const World two = load_world(two_quads(folder, feet));
    ASSERT_EQ(two.grid.y_m.size(), one.grid.y_m.size());
    std::size_t unknown = 0;
    for (int j = 0; j < two.grid.nz; ++j) {
      for (int i = 0; i < two.grid.nx; ++i) {
        if (std::hypot(two.grid.node_x_m(i) - 600, two.grid.node_z_m(j)) < 260) continue;  // the hole
        if (!two.grid.node_known(i, j)) {
          ++unknown;
          continue;
        }
        // Posts and heights are float32: 8 micrometres each at 100 m; feet round a second time.
        ASSERT_NEAR(two.grid.node_y_m(i, j), one.grid.node_y_m(i, j), 1e-3) << i << " " << j;
      }
    }
    EXPECT_EQ(unknown, 0u);
  }
}

TEST(Seams, GroundThatNoFileHasIsNotMadeUpBeyondHalfAPosting) {
  const Folder folder;
  const World world = load_world(two_quads(folder));
  // Nine void posts by nine: 300 m between known posts, of which a rim of 15 m is theirs. Convergence turns
  // the posts by 0.3 degrees, so that places are good to some metres.
  EXPECT_TRUE(std::isnan(world.grid.height_at_m(600, 0)));
  EXPECT_TRUE(std::isnan(world.grid.height_at_m(600 - 120, 0)));
  EXPECT_FALSE(std::isnan(world.grid.height_at_m(600 - 165, 0)));
  const double side_m = 300 - 2 * 15;
  const double void_m2 = static_cast<double>(world.report.posts_absent) * 10 * 10;
  EXPECT_NEAR(void_m2, side_m * side_m, 2 * 4 * side_m * 10 / 2);  // half a cell on every side
}

TEST(Seams, OneFileIsNotWidened) {
  const Folder folder;
  WorldSpec spec = two_quads(folder);
  spec.terrain.dem.resize(1);
  const World world = load_world(spec);
  // Its last posts around the origin stand at x = 0.
  const int i = static_cast<int>(-world.grid.x0_m / 10);
  const int j = static_cast<int>(-world.grid.z0_m / 10);
  EXPECT_TRUE(world.grid.node_known(i - 1, j + 1));
  EXPECT_FALSE(world.grid.node_known(i + 1, j + 1));
}

TEST(Voids, OneMissingPostIsFilledHoweverCoarseTheModel) {
  const Folder folder;
  for (const double post_m : {30.0, 300.0}) {
    RasterPlan plan = quad([](long, long) { return true; });
    plan.geotransform = {kEast_m - 50.3 * post_m, post_m, 0, kNorth_m + 50.2 * post_m, 0, -post_m};
    plan.value = [post_m](double x, double y) {
      return std::hypot(x - kEast_m, y - kNorth_m) < 0.6 * post_m ? kVoid : plane(x, y);
    };
    WorldSpec spec = test::scene(kLon, kLat, 20 * post_m, {write_raster(folder, "hole.tif", plan)});
    const World world = load_world(spec);
    EXPECT_EQ(world.report.posts_absent, 0u) << post_m;
    EXPECT_GE(world.report.posts_filled, 1u) << post_m;
    spec.terrain.fill_void_m = 0;
    EXPECT_GE(load_world(spec).report.posts_absent, 1u) << post_m;
  }
}

TEST(Seams, TheTwoQuadsOfSanFranciscoHaveNoCrackBetweenThem) {
  const std::string south = test::shared_file("sf_city/sanfranciscos.dem");
  const std::string north = test::shared_file("sf_city/San_Fran_North.dem");
  if (south.empty() || north.empty()) {
    GTEST_SKIP() << "no shared data: set OBLIQ_SHARED to the folder that holds data/sf_city";
  }
  // The seam is the parallel 37.75 N of NAD27. One post of it is in neither file: its nodes are a void like
  // any other and filled.
  WorldSpec spec = test::scene(-122.44, 37.75, 3000, {south, north});
  spec.terrain.cell_m = 10;
  for (int turn = 0; turn < 2; ++turn) {
    const World world = load_world(spec);
    EXPECT_EQ(world.report.posts_absent, 0u);
    EXPECT_LE(world.report.posts_filled, 9u);  // three nodes by three around a post of 30 m
    std::swap(spec.terrain.dem[0], spec.terrain.dem[1]);
  }
}

}  // namespace
}  // namespace obliq
