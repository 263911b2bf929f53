// Ground that breaks renderers and loaders: spikes, pits, cliffs, voids, the smallest elevation model,
// integer steps, zone boundaries. tests/unit/terrain/dem/dem_test.cpp covers feet
// (FeetAreReadFromTheBandAndTheSceneFile- OverridesIt and two more) and the load across the antimeridian
// (AntimeridianIsNoBorder); far_antenna_test.cpp has a tower across the antimeridian and at 85 degrees north.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/made_worlds.h"
#include "tests/support/rendered.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"
#include "tests/support/surface_check.h"
#include "tests/unit/terrain_files.h"

namespace obliq::terrain_test {
namespace {

using test::Rendered;
using test::rendered;

constexpr double kLon = -99.5, kLat = 33;

RadarSettings settings() {
  return test::radar_settings(FrustumKind::oblique, {900, 3900, 60}, {12, 40}, {200, 200});
}

double rough(double x, double z) { return 40 * std::sin(x / 300) * std::cos(z / 410); }

TEST(HardTerrain, SpikesAndPitsOfTenKilometresAreSurfacesLikeAnyOther) {
  // Single nodes 10 km above and below their neighbours 50 m away: slopes of 200.
  std::mt19937 random(7);
  World world = test::made_world(4500, 50, rough);
  for (float& y : world.grid.y_m) {
    const auto draw = random() % 1500;
    if (draw == 0) y = 1e4f;
    if (draw == 1) y = -1e4f;
  }
  // None within sight of where the antenna stands.
  for (int j = 0; j < world.grid.nz; ++j)
    for (int i = 0; i < world.grid.nx; ++i)
      if (std::hypot(world.grid.node_x_m(i), world.grid.node_z_m(j)) < 1000)
        world.grid.y_m[world.grid.index(i, j)] = 0;
  const auto scene = test::make_scene(std::move(world));
  for (const test::Sampling& sampling : test::kSamplings) {
    for (const double height_m : {30.0, 850.0, 12000.0}) {
      SCOPED_TRACE(std::string(sampling.name) + " from " + std::to_string(height_m));
      RadarSettings s = test::sampled(settings(), sampling);
      if (height_m > 10000) s.r_min_m = 12050, s.r_max_m = 12900;
      const Rendered r =
          rendered(scene, s, test::pose_at(scene->world(), {3.3, height_m, 2.2}, 30), sampling);
      // A symmetric camera that must see from nadir to zenith has pixels of 3 degrees: it may meet nothing.
      if (sampling.frustum != FrustumKind::symmetric) {
        EXPECT_TRUE(r.refused || r.totals.power_w > 0);
      }
    }
  }
}

TEST(HardTerrain, TheFlankOfASpikeWhoseTopIsBeyondTheSwathIsSeen) {
  // A spike of 10 km one kilometre away, with a swath to 3.9 km: its top is out of range, its flank fills the
  // sky from 1 to 3.9 km of range. Rays must be cast up there; a sector that is bounded by the posts inside
  // the swath alone looks below the horizon only.
  const auto scene = test::make_scene(test::made_world(4500, 50, [](double x, double z) {
    return std::abs(z - 1500) < 30 && std::abs(x) < 700 ? 10000.0 : 0.0;
  }));
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    s.pixel_rows = 1000;  // half of them above the horizon, 0.15 degrees each: 20 m of range at 3,600 m
    const Rendered r = rendered(scene, s, test::pose_at(scene->world(), {3.3, 500, 2.2}, 0), sampling);
    if (r.refused) continue;
    // The wall's face at ranges beyond 1,600 m lies above the antenna: 2,600 m of bins that only it fills in
    // the middle azimuths.
    for (int range = 12; range < 38; ++range)
      EXPECT_EQ(r.frame.bins.state[static_cast<std::size_t>(6 * 40 + range)], 1) << "range bin " << range;
  }
}

TEST(HardTerrain, CliffsOfAKilometreInOneCellAreSeenFromBothSides) {
  for (const bool towards : {true, false}) {
    const auto scene = test::make_scene(test::made_world(
        4500, 50, [&](double x, double z) { return rough(x, z) + ((z > 2000) == towards ? 1000.0 : 0.0); }));
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(sampling.name);
      RadarSettings s = test::sampled(settings(), sampling);
      s.r_min_m = 1200;
      const double height_m = towards ? 600 : 1700;
      const Rendered r =
          rendered(scene, s, test::pose_at(scene->world(), {3.3, height_m, 2.2}, 30), sampling);
      if (r.refused) continue;
      EXPECT_GT(r.totals.power_w, 0);
      EXPECT_GT(r.totals.of_state[2], 20u) << "behind the cliff";
    }
  }
}

TEST(HardTerrain, VoidsOfEverySizeAreNoSurfaceAndNeverHit) {
  std::mt19937 random(11);
  for (const unsigned one_in : {2u, 10u, 300u}) {
    World world = test::made_world(4500, 50, rough);
    for (float& y : world.grid.y_m)
      if (random() % one_in == 0) y = std::numeric_limits<float>::quiet_NaN();
    const auto scene = test::make_scene(std::move(world));
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(std::string(sampling.name) + ", one post in " + std::to_string(one_in) + " unknown");
      const RadarSettings s = test::sampled(settings(), sampling);
      const Pose pose = test::pose_at(scene->world(), {3.3, 800, 2.2}, 30);
      const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
      ASSERT_TRUE(planned.plan);
      const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
      test::expect_sane(frame, s, scene->materials());
      EXPECT_GT(frame.stats.samples, 0u);
      // Every hit lies on a known cell: the tracer's tiles leave the others out.
      struct OnKnown : HitObserver {
        const World& world;
        int wrong = 0;
        explicit OnKnown(const World& w) : world(w) {}
        void on_hit(std::uint32_t, double, const ExactHit& hit) override {
          const double top = world.grid.height_at_m(hit.position_m.x, hit.position_m.z);
          // Exactly on a known cell's edge the point may count to its unknown neighbour.
          if (!(std::abs(top - hit.position_m.y) < 1e-6)) {
            const double aside = 1e-6;
            bool near = false;
            for (const double dx : {-aside, aside})
              for (const double dz : {-aside, aside})
                near |= std::abs(world.grid.height_at_m(hit.position_m.x + dx, hit.position_m.z + dz) -
                                 hit.position_m.y) < 1e-5;
            wrong += near ? 0 : 1;
          }
        }
      } observer(scene->world());
      RenderOptions options;
      options.threads = 1;
      options.observer = &observer;
      render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
      EXPECT_EQ(observer.wrong, 0);
    }
  }
}

/// A scene of one raster around the usual place, seen from 800 m above its centre.
struct Loaded {
  std::shared_ptr<const Scene> scene;
  Pose pose;
};

Loaded load(const WorldSpec& spec, double height_m) {
  Loaded loaded;
  loaded.scene = test::make_scene(load_world(spec));
  loaded.pose = test::pose_over_origin(loaded.scene->world(), height_m, 20);
  return loaded;
}

test::RasterPlan model(double value, const std::string& type) {
  test::RasterPlan plan = test::around(kLon, kLat, [value](double, double) { return value; });
  plan.columns = plan.rows = 121;
  plan.geotransform = {kLon - 60.5 / 1200, 1.0 / 1200, 0, kLat + 60.5 / 1200, 0, -1.0 / 1200};
  plan.type = type;
  return plan;
}

TEST(HardTerrain, AConstantElevationModelIsAPlaneOfTheClosedFormsPower) {
  // Also below sea level: the Dead Sea's shore lies at -430 m.
  const test::Folder folder;
  for (const double level_m : {0.0, 123.0, -430.0}) {
    const std::string dem = test::write_raster(folder, "constant.tif", model(level_m, "Int16"));
    WorldSpec spec = test::scene(kLon, kLat, 4200, {dem});
    spec.terrain.cell_m = 50;
    const Loaded loaded = load(spec, level_m + 800);
    for (const float y : loaded.scene->world().grid.y_m)
      EXPECT_NEAR(y, level_m, 2e-3);  // the plumb line over 6 km: level x (6 / 6371)^2 / 2, and float32
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(std::string(sampling.name) + " over " + std::to_string(level_m));
      const RadarSettings s = test::sampled(settings(), sampling);
      const Rendered r = rendered(loaded.scene, s, loaded.pose, sampling);
      ASSERT_FALSE(r.refused);
      // Pixels that straddle the swath's edges: one row in 200 of the steepest part, (15 m / 900 m) x 3 = 5 %
      // at worst for the cameras; a height taken in feet or a sign lost is off by 70 % and more.
      EXPECT_NEAR(r.totals.power_w / test::flat_ground_power_w(s, 1, 800), 1, 0.02);
    }
  }
}

TEST(HardTerrain, TheSmallestElevationModelIsTwoByTwoPosts) {
  const test::Folder folder;
  test::RasterPlan plan = model(100, "Float32");
  plan.columns = plan.rows = 2;
  plan.geotransform = {kLon - 1.0 / 30, 1.0 / 30, 0, kLat + 1.0 / 30, 0, -1.0 / 30};  // posts 3.7 km apart
  plan.value = [](double lon, double) { return lon < kLon ? 100.0 : 200.0; };
  WorldSpec spec = test::scene(kLon, kLat, 4000, {test::write_raster(folder, "four.tif", plan)});
  const World automatic = load_world(spec);  // cells as wide as the posting: the fewest nodes there can be
  EXPECT_GE(automatic.grid.nx, 2);
  EXPECT_GE(automatic.grid.nz, 2);
  spec.terrain.cell_m = 50;
  const Loaded loaded = load(spec, 1000);
  const HeightGrid& grid = loaded.scene->world().grid;
  // Bilinear between the posts at -+1/60 degree, 1,558 m; the nearest post beyond.
  EXPECT_NEAR(grid.height_at_m(0, 0), 150, 0.1);
  EXPECT_NEAR(grid.height_at_m(-2500, 0), 100, 0.1);
  EXPECT_NEAR(grid.height_at_m(2500, 700), 200, 0.1);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    EXPECT_GT(
        rendered(loaded.scene, test::sampled(settings(), sampling), loaded.pose, sampling).totals.power_w, 0);
  }
  // A world of one cell, every node of it an edge.
  const auto cell = test::make_scene(test::made_world(3000, 3000, [](double, double) { return 0.0; }));
  ASSERT_EQ(cell->world().grid.nx, 3);
  World one = test::made_world(3000, 3000, [](double, double) { return 0.0; });
  one.grid.nx = one.grid.nz = 2;
  one.grid.y_m.assign(4, 0.0f);
  const auto single = test::make_scene(std::move(one));
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    s.r_max_m = 2500;
    const Rendered r = rendered(single, s, test::pose_at(single->world(), {-1500, 800, -2000}, 10), sampling);
    EXPECT_GT(r.totals.power_w, 0);
  }
}

TEST(HardTerrain, IntegerStepsAreATerraceNotAFault) {
  // A slope of 1 in 100 in whole metres: a step of 1 m every 93 m. Heights are within half a metre, and seen
  // from 12 degrees and more above, steeper than any riser's shadow matters, the power is that of the slope
  // to the share of risers: 0.011 of slope over a depression of 0.2, 5 %, in either direction.
  const test::Folder folder;
  const auto slope = [](double lon, double) { return 300 + 1000 * (lon - kLon); };
  test::RasterPlan smooth = model(0, "Float32"), steps = model(0, "Int16");
  smooth.value = slope;
  steps.value = [&](double lon, double lat) { return std::round(slope(lon, lat)); };
  const auto loaded = [&](const char* name, const test::RasterPlan& plan) {
    WorldSpec spec = test::scene(kLon, kLat, 4200, {test::write_raster(folder, name, plan)});
    spec.terrain.cell_m = 30;
    return load(spec, 1100);
  };
  const Loaded a = loaded("smooth.tif", smooth), b = loaded("steps.tif", steps);
  const std::vector<float>& fine = a.scene->world().grid.y_m;
  for (std::size_t k = 0; k < fine.size(); ++k) EXPECT_NEAR(fine[k], b.scene->world().grid.y_m[k], 0.51);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const Rendered of_slope = rendered(a.scene, s, a.pose, sampling);
    const Rendered of_steps = rendered(b.scene, s, b.pose, sampling);
    EXPECT_NEAR(of_steps.totals.power_w / of_slope.totals.power_w, 1, 0.05);
  }
}

TEST(HardTerrain, SpikesInAFileAreKeptUpwardsAndVoidWhereNoLandIs) {
  // +10 km is nothing that the loader can know to be wrong; -10 km is below any land and filled like a void.
  const test::Folder folder;
  test::RasterPlan plan = model(0, "Float32");
  plan.value = [](double lon, double lat) {
    const bool at_lat = std::abs(lat - kLat - 10.0 / 1200) < 0.4 / 1200;
    if (at_lat && std::abs(lon - kLon) < 0.4 / 1200) return 10000.0;
    if (at_lat && std::abs(lon - kLon - 20.0 / 1200) < 0.4 / 1200) return -10000.0;
    return 50.0;
  };
  WorldSpec spec = test::scene(kLon, kLat, 4200, {test::write_raster(folder, "spikes.tif", plan)});
  spec.terrain.cell_m = 50;
  const Loaded loaded = load(spec, 900);
  const HeightGrid& grid = loaded.scene->world().grid;
  float low = HUGE_VALF, high = -HUGE_VALF;
  for (const float y : grid.y_m) low = std::min(low, y), high = std::max(high, y);
  EXPECT_EQ(loaded.scene->world().report.posts_absent, 0u);
  EXPECT_GT(loaded.scene->world().report.posts_filled, 0u);
  // Bilinear between posts of 78 and 92 m: a node within 25 m of the spike has at least half of it.
  EXPECT_GT(high, 4000);
  EXPECT_NEAR(low, 50, 0.01);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    rendered(loaded.scene, test::sampled(settings(), sampling), loaded.pose, sampling);
  }
}

TEST(HardTerrain, TwoUtmZonesMeetWithoutACrack) {
  // Zones 10 and 11 meet at 120 W. Two files, each in its own zone, overlap there by a kilometre; the value
  // is a function of the place alone, which another program turned into each file's system:
  //   echo -120 38 | gdaltransform -s_srs EPSG:4269 -t_srs EPSG:26910   763421.376 4210063.034
  //   the same to EPSG:26911                                            236578.624 4210063.034
  const test::Folder folder;
  const auto file = [&](const char* crs, double x0, double side, const char* name) {
    test::RasterPlan plan;
    plan.crs = crs;
    plan.columns = 200;
    plan.rows = 400;
    const double north = 4210063.034, west = side < 0 ? x0 - 30 * 180 : x0 - 30 * 20;
    plan.geotransform = {west, 30, 0, north + 30 * 200, 0, -30};
    // Distance from the meeting point along each file's own axes: the two differ by twice the convergence of
    // 1.85 degrees, 3.7 degrees of turn, so the value takes the turn back.
    const double turn = (side < 0 ? -1 : 1) * 1.8473 * kDegree_rad;
    plan.value = [=](double x, double y) {
      const double e = x - x0, n = y - north;
      return 500 + 0.02 * (e * std::cos(turn) - n * std::sin(turn)) +
             0.01 * (e * std::sin(turn) + n * std::cos(turn));
    };
    return test::write_raster(folder, name, plan);
  };
  WorldSpec spec = test::scene(
      -120, 38, 4500,
      {file("EPSG:26910", 763421.376, -1, "ten.tif"), file("EPSG:26911", 236578.624, 1, "eleven.tif")});
  spec.terrain.cell_m = 30;
  const World world = load_world(spec);
  EXPECT_EQ(world.report.posts_absent, 0u);
  // The plane in east and north: scale 1.00045 at the zones' edges and the change of convergence over 4.5 km
  // leave 0.063 m at the corners, by gdaltransform. A border's last posts drawn out by half a pixel, 15 m x
  // 0.02, leave a step of 0.3 m.
  double worst = 0;
  for (int j = 0; j < world.grid.nz; ++j)
    for (int i = 0; i < world.grid.nx; ++i)
      worst = std::max(worst, std::abs(world.grid.node_y_m(i, j) - 500 - 0.02 * world.grid.node_x_m(i) -
                                       0.01 * world.grid.node_z_m(j)));
  std::printf("    worst %.3f m from the plane\n", worst);
  EXPECT_LT(worst, 0.08);
}

TEST(HardTerrain, BothNamesOfTheAntimeridianAreOnePlace) {
  const test::Folder folder;
  test::RasterPlan plan = model(50, "Float32");
  plan.geotransform[0] = 180 - 60.5 / 1200;
  plan.value = [](double lon, double lat) { return 50 + 40 * std::sin(lon * 3000) * std::cos(lat * 2000); };
  const std::string dem = test::write_raster(folder, "dateline.tif", plan);
  WorldSpec spec = test::scene(180, kLat, 4200, {dem});
  spec.terrain.cell_m = 50;
  const auto scene = test::make_scene(load_world(spec));
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const auto frame = [&](double longitude_deg) {
      PoseSettings at;
      at.latitude_deg = kLat;
      at.longitude_deg = longitude_deg;
      at.height_m = 900;
      std::vector<FieldError> errors;
      return render(scene, test::snapshot(s), place_antenna(scene->world(), at, errors).value(), {0, 12});
    };
    const Frame east = frame(180), west = frame(-180);
    EXPECT_GT(east.stats.samples, 1000u);
    EXPECT_EQ(east.bins.power_w, west.bins.power_w);
    EXPECT_EQ(east.bins.iq, west.bins.iq);
  }
}

}  // namespace
}  // namespace obliq::terrain_test
