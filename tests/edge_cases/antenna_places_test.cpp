// Antennas in hard places: very low, very high, below sea level, over no ground at all, below peaks, in a
// canyon, exactly over the mesh's own lines. far_antenna_test.cpp has those far from the scene's origin.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/radar/frame_plan.h"
#include "tests/support/made_worlds.h"
#include "tests/support/rendered.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"
#include "tests/support/surface_check.h"

namespace obliq::antenna_places_test {
namespace {

using test::Rendered;
using test::rendered;

// A ray that starts within rounding of the ground may go unanswered; none may be answered wrongly.
constexpr test::RenderChecks kOnSurface{.none_rejected = false};
constexpr test::RenderChecks kSane{.on_surface = false, .none_rejected = false};

RadarSettings settings(double r_min_m, double r_max_m) {
  return test::radar_settings(FrustumKind::oblique, {r_min_m, r_max_m, 60}, {12, 40}, {240, 240});
}

std::vector<Material> one_material() { return {test::two_materials()[0], test::two_materials()[0]}; }

TEST(HardAntenna, AtOneMetreAHundredMetresAndTwentyKilometresKeepsTheClosedFormsPower) {
  struct Case {
    double height_m, r_min_m, r_max_m;
  };
  const auto scene = test::make_scene(test::made_world(36000, 300, [](double, double) { return 0.0; }));
  for (const Case& c : {Case{1, 60, 600}, Case{100, 400, 4000}, Case{20000, 22000, 35000}}) {
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(std::string(sampling.name) + " at " + std::to_string(c.height_m));
      const RadarSettings s = test::sampled(settings(c.r_min_m, c.r_max_m), sampling);
      const Rendered r =
          rendered(scene, s, test::pose_at(scene->world(), {17.3, c.height_m, -41.2}, 25), sampling, kSane);
      ASSERT_FALSE(r.refused);
      std::printf("    %s at %.0f m: %+.4f\n", sampling.name, c.height_m,
                  r.totals.power_w / test::flat_ground_power_w(s, 1, c.height_m) - 1);
      // A pixel is in or out of the swath by its centre: half a row of the near edge, where a row of the
      // oblique camera is (r_max - r_min cos 30) / 240 = 1 % of r_min and power goes with r^-3, is 2 %; half
      // a column on either side of a sector that is 13 columns wide there, 4 %, evens out between rows.
      EXPECT_NEAR(r.totals.power_w / test::flat_ground_power_w(s, 1, c.height_m), 1, 0.04);
    }
  }
}

TEST(HardAntenna, BelowSeaLevelNothingChangesButTheDatum) {
  // The same land 430 m lower. Heights are multiples of 1/64 m, so that float32 and the antenna's height
  // above them are exact in both: only the sums of world coordinates in doubles round differently.
  const auto scene_at = [](double level) {
    return test::make_scene(
        test::made_world(5000, 50,
                         [level](double x, double z) {
                           return level + std::round(64 * 90 * std::sin(x / 400) * std::cos(z / 300)) / 64;
                         }),
        one_material());
  };
  const auto high = scene_at(0), low = scene_at(-430);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(800, 4500), sampling);
    const Rendered a =
        rendered(high, s, test::pose_at(high->world(), {17.25, 700, -41.5}, 25), sampling, kOnSurface);
    const Rendered b =
        rendered(low, s, test::pose_at(low->world(), {17.25, 270, -41.5}, 25), sampling, kOnSurface);
    EXPECT_FALSE(a.refused || b.refused);
    EXPECT_EQ(a.frame.bins.state, b.frame.bins.state);
    // Rays whose float32 origin and direction meet an edge may find its other side: 1 in 10,000 moves by no
    // more than its own pixel's power.
    EXPECT_NEAR(b.totals.power_w / a.totals.power_w, 1, 1e-4);
  }
}

TEST(HardAntenna, OverNoKnownGroundSeesTheCoastAhead) {
  // Ground begins 2 km ahead; below the antenna and beside it nothing is known. The scene's ground is at sea
  // level, on a curved earth.
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 9000, 100);
  spec.radius_factor = 4.0 / 3;
  World world = load_world(spec);
  for (int j = 0; j < world.grid.nz; ++j)
    for (int i = 0; i < world.grid.nx; ++i)
      if (world.grid.node_z_m(j) < 2000)
        world.grid.y_m[world.grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
  const auto scene = test::make_scene(std::move(world));
  for (const test::Sampling& sampling : test::kSamplings) {
    for (const double height_m : {5.0, 400.0}) {
      SCOPED_TRACE(std::string(sampling.name) + " at " + std::to_string(height_m));
      const RadarSettings s = test::sampled(settings(500, 8000), sampling);
      const Rendered r =
          rendered(scene, s, test::pose_at(scene->world(), {3.25, height_m, -41.5}, 0), sampling, kOnSurface);
      if (r.refused) continue;
      EXPECT_GT(r.totals.power_w, 0);
      EXPECT_GE(r.totals.nearest_m, 2041 - 7500.0 / 40);
      // Bins that end before the coast: no surface in any of the 12 azimuths.
      EXPECT_GE(r.totals.of_state[3], 12u * static_cast<unsigned>((2041 - 500) / (7500.0 / 40)));
    }
  }
}

TEST(HardAntenna, BelowSurroundingPeaksSeesThemAllAroundAndNothingBehind) {
  // A basin of 1 km inside a ring wall that climbs by 800 m to its crest at 3 km; behind it the ground falls.
  const auto scene = test::make_scene(
      test::made_world(6000, 50,
                       [](double x, double z) {
                         const double r = std::hypot(x, z);
                         return r < 1000 ? 0.0 : r < 3000 ? 0.4 * (r - 1000) : 800 - 0.3 * (r - 3000);
                       }),
      one_material());
  const double height_m = 60;
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(sampling.rays() ? 100 : 10, 5500), sampling);
    if (sampling.frustum != FrustumKind::symmetric) s.sector_deg = 360;
    const Rendered r =
        rendered(scene, s, test::pose_at(scene->world(), {3.25, height_m, -41.5}, 77), sampling, kOnSurface);
    EXPECT_TRUE(!r.refused || sampling.rays());
    if (r.refused) continue;
    // The crest is sqrt(3000^2 + 740^2) = 3,090 m away, +- 42 m of the antenna's offset and 25 m of the mesh.
    const double bin_m = (s.r_max_m - s.r_min_m) / s.range_bins;
    EXPECT_LE(r.totals.farthest_m, 3090 + 67 + bin_m);
    if (sampling.frustum == FrustumKind::symmetric) continue;
    for (int a = 0; a < 12; ++a) {
      int sampled = 0;
      for (int k = 0; k < 40; ++k) sampled += r.frame.bins.state[static_cast<std::size_t>(a * 40 + k)] == 1;
      EXPECT_GE(sampled, 20) << "azimuth bin " << a;
      for (int k = 0; k < 40; ++k)
        EXPECT_NE(r.frame.bins.state[static_cast<std::size_t>(a * 40 + k)], 3) << "known ground everywhere";
    }
  }
}

TEST(HardAntenna, InACanyonSeesItsWallsAndItsFloor) {
  // 400 m wide, walls of 500 m that rise within one cell, running north. The antenna hangs 100 m above the
  // floor: the plateau cannot be seen.
  const auto scene = test::make_scene(
      test::made_world(6000, 50, [](double x, double) { return std::abs(x) < 200 ? 0.0 : 500.0; }),
      one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    for (const double bearing_deg : {0.0, 45.0, 90.0, 180.0}) {
      const RadarSettings s = test::sampled(settings(150, 5500), sampling);
      const Rendered r = rendered(scene, s, test::pose_at(scene->world(), {12.5, 100, -41.5}, bearing_deg),
                                  sampling, kOnSurface);
      EXPECT_TRUE(!r.refused || sampling.rays());
      if (r.refused) continue;
      if (sampling.frustum == FrustumKind::symmetric) continue;
      EXPECT_GT(r.totals.power_w, 0);
      // Across, the wall's top is at most sqrt((250 / cos 30)^2 + 400^2) = 494 m away.
      if (bearing_deg == 90) {
        EXPECT_LE(r.totals.farthest_m, 494 + 5350.0 / 40);
      }
    }
  }
}

TEST(HardAntenna, ExactlyOverTheMeshsOwnLinesLosesNoRay) {
  // Over a node, an edge and a diagonal, looking along them, with an odd number of columns: the middle column
  // runs along the line itself. On flat ground that reaches beyond the swath every ray must hit.
  const auto scene = test::make_scene(test::made_world(6000, 64, [](double, double) { return 0.0; }));
  for (const test::Sampling& sampling : test::kSamplings) {
    for (const auto& [x, z] : {std::pair{64.0, 128.0}, {96.0, 128.0}, {96.0, 96.0}, {64.0, 70.7}}) {
      for (const double bearing_deg : {0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0}) {
        SCOPED_TRACE(std::string(sampling.name) + " over " + std::to_string(x) + ", " + std::to_string(z) +
                     " looking " + std::to_string(bearing_deg));
        RadarSettings s = test::sampled(settings(1024, 4000), sampling);
        s.pixel_columns = 3;
        s.azimuth_bins = 3;
        const Rendered r =
            rendered(scene, s, test::pose_at(scene->world(), {x, 512, z}, bearing_deg), sampling, kSane);
        if (sampling.rays()) {
          EXPECT_EQ(r.frame.stats.hits, r.frame.stats.rays);
        }
        if (!sampling.rays()) {
          EXPECT_EQ(r.totals.of_state[0], 0u);
        }
        EXPECT_GT(r.totals.power_w, 0);
        EXPECT_EQ(r.totals.of_state[2] + r.totals.of_state[3], 0u);
      }
    }
  }
}

TEST(HardAntenna, OnTheGridsBorderAndOutsideItSeesWhatThereIs) {
  const auto scene = test::make_scene(
      test::made_world(4000, 50,
                       [](double x, double z) { return 30 * std::sin(x / 200) + 20 * std::cos(z / 350); }),
      one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    // On the last node's corner, on the border, just outside, far outside; looking in and away.
    for (const glm::dvec3& antenna : {glm::dvec3(-4000, 600, -4000), glm::dvec3(0, 600, -4000),
                                      glm::dvec3(0, 600, -4000.001), glm::dvec3(100, 600, -5500)}) {
      for (const double bearing_deg : {0.0, 180.0, 90.0}) {
        SCOPED_TRACE(std::string(sampling.name) + " at " + std::to_string(antenna.x) + ", " +
                     std::to_string(antenna.z) + " looking " + std::to_string(bearing_deg));
        const RadarSettings s = test::sampled(settings(800, 3500), sampling);
        const Rendered r =
            rendered(scene, s, test::pose_at(scene->world(), antenna, bearing_deg), sampling, kOnSurface);
        if (r.refused) continue;
        if (bearing_deg == 0) {
          EXPECT_GT(r.totals.power_w, 0);
        }
        if (bearing_deg == 180 && antenna.z < -4000.5) {
          EXPECT_EQ(r.totals.of_state[3], 12u * 40u);
        }
      }
    }
  }
}

TEST(HardAntenna, TheLongestRangesThatAreAllowedAreFinite) {
  // 500 km from 15 km up over a 4/3 earth, where the horizon is. Cells of 4 km: chords lie s^2 / 8 k R = 0.24
  // m below the sphere.
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 510000, 4096);
  spec.radius_factor = 4.0 / 3;
  const auto scene = test::make_scene(load_world(spec));
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(16000, 500000), sampling);
    s.pixel_rows = 2048;
    const Rendered r = rendered(scene, s, test::pose_over_origin(scene->world(), 14000, 25), sampling, kSane);
    ASSERT_FALSE(r.refused);
    EXPECT_GT(r.totals.power_w, 0);
    // sqrt(2 k R h) = 488 km, less 3.7e-4 of it for h beside 2 k R; the ellipsoid's radius is within 0.3 % of
    // the mean, 1.5 km; the chords move the tangent point by sqrt(2 k R 0.24 m) = 2 km.
    EXPECT_LE(r.totals.farthest_m, 488e3 + 3.5e3 + 484e3 / 40);
  }
}

TEST(HardAntenna, JustAboveTheHighestGroundIsAboveIt) {
  // The oblique camera's viewing plane lies kappa below the antenna: a nanometre, a micrometre, a millimetre.
  // Embree, whose origin is rounded to 8 micrometres here, meets the hill's top where the exact ray passes
  // over it; such rays may be rejected, and none may be taken for a hit.
  const auto scene = test::make_scene(
      test::made_world(5000, 50,
                       [](double x, double z) { return std::hypot(x, z - 2000) < 100 ? 64.0 : 0.0; }),
      one_material());
  for (const test::Sampling& sampling : test::kSamplings) {
    for (const double above_m : {0.0, 1e-9, 1e-6, 1e-3}) {
      SCOPED_TRACE(std::string(sampling.name) + " above by " + std::to_string(above_m));
      const RadarSettings s = test::sampled(settings(500, 4500), sampling);
      const Rendered r = rendered(scene, s, test::pose_at(scene->world(), {3.25, 64 + above_m, -41.5}, 0),
                                  sampling, kOnSurface);
      EXPECT_EQ(r.refused, above_m == 0 && sampling.frustum == FrustumKind::oblique);
    }
  }
}

TEST(HardAntenna, WithNothingInRangeGivesAnEmptyFrame) {
  const auto scene = test::make_scene(test::made_world(5000, 50, [](double, double) { return 0.0; }));
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(300, 4500), sampling);
    const Rendered r =
        rendered(scene, s, test::pose_at(scene->world(), {3.25, 4600, -41.5}, 0), sampling, kOnSurface);
    if (r.refused) continue;
    EXPECT_EQ(r.totals.power_w, 0);
    EXPECT_EQ(r.totals.of_state[4], 12u * 40u) << "all of it is nearer than the ground";
  }
}

TEST(HardAntenna, OverThePolesAndTheEquatorSeesTheSameFlatGround) {
  // The world frame and its north at both ends of latitude. Over synthetic ground of a curved earth only the
  // ellipsoid's radius differs, by 1 % between pole and equator: at 4.5 km and below no ray is moved by more
  // than d^2 / 2R x 1 % = 2 cm.
  double at_the_origin[std::size(test::kSamplings)] = {};
  for (const double latitude_deg : {33.0, 0.0, 90.0, -90.0}) {
    WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 6000, 100);
    spec.radius_factor = 4.0 / 3;
    spec.origin = {-99.5, latitude_deg};
    spec.reaches = {{spec.origin, 6000}};
    const auto scene = test::make_scene(load_world(spec));
    PoseSettings at;
    at.latitude_deg = latitude_deg;
    at.longitude_deg = -99.5;
    at.height_m = 700;
    at.bearing_deg = 41;
    std::vector<FieldError> errors;
    const auto pose = place_antenna(scene->world(), at, errors);
    ASSERT_TRUE(pose);
    EXPECT_NEAR(pose->north_rad, 0, 1e-12);
    double* expected = at_the_origin;
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(std::string(sampling.name) + " at latitude " + std::to_string(latitude_deg));
      const RadarSettings s = test::sampled(settings(1000, 4500), sampling);
      const Rendered r = rendered(scene, s, *pose, sampling, kSane);
      if (latitude_deg == 33) *expected = r.totals.power_w;
      EXPECT_NEAR(r.totals.power_w / *expected++, 1, 1e-3);
    }
  }
}

}  // namespace
}  // namespace obliq::antenna_places_test
