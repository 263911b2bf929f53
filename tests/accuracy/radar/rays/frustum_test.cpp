// The two camera frusta: published step sizes, the projection matrix against the per-pixel ray directions,
// and whether the camera sees all of the sector.
// What a frustum's rays meet, found by a march, against each ray's own walk through the grid's cells and the
// buildings near it, in hundreds of thousands of rays of random scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <glm/vec4.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "server/radar/geometry/perspective_frustum.h"
#include "server/radar/rays/first_hits.h"
#include "server/radar/rays/ray_samples.h"
#include "server/scene/ray_answer.h"
#include "terrain/base/errors.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::frustum_test {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;

/// Equal to the digits that are printed: half a unit of the last one.
void expect_digits(double value, const char* printed) {
  char text[64];
  std::snprintf(text, sizeof text, "%#.4g", value);
  std::string mine = text;
  if (printed[0] == '0') {
    std::snprintf(text, sizeof text, "%.4f", value);  // the paper's smallest step is given to 4 decimals
    mine = text;
  }
  EXPECT_EQ(mine, printed);
}

TEST(FrustumSteps, AreTheCheckValuesOfFlatGroundToFourDigits) {
  // Antenna at 1 km, 2048 rows, r_min = r_max / 10, no sector: derived by hand from the corrected eqs. (20),
  // (21), (29), (30); the paper's Figure 6 shows the same curves.
  const auto steps = [](FrustumKind kind, double r_max) {
    return flat_steps(kind, 1000, r_max / 10, r_max, 2048);
  };
  expect_digits(steps(FrustumKind::symmetric, 100e3).far_m, "437.7");
  expect_digits(steps(FrustumKind::symmetric, 100e3).near_m, "4.377");
  expect_digits(steps(FrustumKind::symmetric, 37e3).far_m, "162.4");
  expect_digits(steps(FrustumKind::symmetric, 37e3).near_m, "1.572");
  expect_digits(steps(FrustumKind::oblique, 100e3).far_m, "43.97");
  expect_digits(steps(FrustumKind::oblique, 100e3).near_m, "43.75");
  expect_digits(steps(FrustumKind::oblique, 37e3).far_m, "16.31");
  expect_digits(steps(FrustumKind::oblique, 37e3).near_m, "15.72");
  expect_digits(steps(FrustumKind::oblique, 10e3).far_m, "4.834");
  expect_digits(steps(FrustumKind::oblique, 10e3).near_m, "0.0118");
}

TEST(FrustumSteps, AreThoseThatTheProgramPrints) {
  FILE* pipe = popen(OBLIQ_PROGRAM " frustum --flat-check", "r");
  ASSERT_TRUE(pipe);
  std::vector<std::string> rows;
  char line[256];
  while (std::fgets(line, sizeof line, pipe)) {
    std::istringstream words(line);
    std::string row;
    for (std::string word; words >> word;) row += (row.empty() ? "" : " ") + word;
    rows.push_back(row);
  }
  EXPECT_EQ(pclose(pipe), 0);
  ASSERT_GE(rows.size(), 3u);
  EXPECT_EQ(rows[rows.size() - 2], "37 162.4 1.572 16.31 15.72");
  EXPECT_EQ(rows[rows.size() - 1], "100 437.7 4.377 43.97 43.75");
}

TEST(FrustumSteps, OfTheSymmetricCameraAreEqualAnglesBetweenItsEdges) {
  // Without the camera: rows are equally spaced tangents either side of the axis that bisects the angles of
  // the far and the close edge, both measured from the nadir.
  for (const double r_max : {20e3, 37e3, 64e3, 100e3}) {
    const double far = std::acos(1000 / r_max), close = std::acos(1000 / (r_max / 10));
    const double axis = (far + close) / 2, half = (far - close) / 2;
    const auto range = [&](double edge) {  // edge 0 far, 2048 close
      return 1000 / std::cos(axis + std::atan(std::tan(half) * (1 - edge / 1024)));
    };
    const StepSizes steps = flat_steps(FrustumKind::symmetric, 1000, r_max / 10, r_max, 2048);
    EXPECT_NEAR(steps.far_m, range(0) - range(1), 1e-6);
    EXPECT_NEAR(steps.near_m, range(2047) - range(2048), 1e-6);
  }
}

struct Box {
  double above_bottom_m, height_m, r_min_m, r_max_m;
};

/// Flat, hilly, steep, near, far, and one where the bottom is farther below than r_min (g_min = 0).
constexpr Box kBoxes[] = {{1000, 0, 3700, 37000},    {1000, 500, 3700, 37000},  {3000, 2400, 3700, 37000},
                          {3000, 100, 3000, 30000},  {500, 499, 600, 5000},     {10000, 2000, 10000, 100000},
                          {1500, 900, 1200, 15000},  {200, 30, 2000, 9000},     {9000, 8000, 4000, 250000},
                          {1000, 0.001, 1000, 1001}, {2500, 1000, 2400, 60000}, {50, 49.9, 50, 40000}};

/// Every frustum that exists for the boxes and these sectors.
template <class Check>
int for_each_frustum(Check&& check) {
  int refused = 0;
  for (const Box& b : kBoxes) {
    for (const double sector_deg : {10.0, 60.0, 120.0, 170.0, 180.0, 200.0, 270.0, 360.0}) {
      const double sector = sector_deg * kDegree_rad;
      const SectorBox box(b.above_bottom_m, b.height_m, b.r_min_m, b.r_max_m, sector);
      check(b, sector, oblique_frustum(box, 640, 480));
      if (sector_deg >= 180) continue;
      try {
        check(b, sector, symmetric_frustum(box, sector, 640, 480));
      } catch (const InputError&) {
        ++refused;  // a corner of the sector lies beside or behind the camera
      }
    }
  }
  return refused;
}

TEST(FrustumProjection, SendsEveryPixelRayToThatPixelsPlaceOnTheScreen) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for_each_frustum([&](const Box&, double, const PerspectiveFrustum& f) {
    const glm::dmat4 clip_from_antenna = f.clip_from_camera() * f.camera_from_antenna();
    for (int n = 0; n < 200; ++n) {
      const double column = n < 4 ? (n & 1 ? 639.0 : 0.0) : std::floor(640 * unit(random));
      const double row = n < 4 ? (n & 2 ? 479.0 : 0.0) : std::floor(480 * unit(random));
      // Anywhere along the ray: the projection must not depend on the distance.
      const glm::dvec3 p = (0.5 + 10 * unit(random)) * f.direction(column, row);
      const glm::dvec4 clip = clip_from_antenna * glm::dvec4(p, 1.0);
      ASSERT_GT(clip.w, 0) << "the ray points behind the camera";
      // OpenGL's screen: x and y from -1 to 1, row 0 on top. A thousandth of a pixel is 4e-6.
      EXPECT_NEAR(clip.x / clip.w, 2 * (column + 0.5) / 640 - 1, 1e-9);
      EXPECT_NEAR(clip.y / clip.w, 1 - 2 * (row + 0.5) / 480, 1e-9);
    }
  });
}

TEST(FrustumProjection, IsEquationFourInItsCorrectedForm) {
  for_each_frustum([&](const Box&, double, const PerspectiveFrustum& f) {
    const glm::dmat4 m = f.clip_from_camera();  // m[column][row]
    const double wide = f.right_m - f.left_m, high = f.top_m - f.bottom_m;
    EXPECT_DOUBLE_EQ(m[0][0], 2 * f.near_m / wide);
    EXPECT_DOUBLE_EQ(m[1][1], 2 * f.near_m / high);
    EXPECT_NEAR(m[2][0], (f.right_m + f.left_m) / wide, 1e-12);
    EXPECT_NEAR(m[2][1], (f.top_m + f.bottom_m) / high, 1e-12);
    EXPECT_EQ(m[2][3], -1);
    EXPECT_EQ(m[3][3], 0);
  });
}

TEST(FrustumProjection, OfTheObliqueCameraDividesTheTerrainTopEvenly) {
  for_each_frustum([&](const Box& b, double sector, const PerspectiveFrustum& f) {
    if (f.kind != FrustumKind::oblique) return;
    const double kappa = b.above_bottom_m - b.height_m;
    const double g_max = std::sqrt(b.r_max_m * b.r_max_m - kappa * kappa);
    const double half_width = g_max * std::sin(std::min(sector, std::numbers::pi) / 2);
    // Where the ray of the first, a middle and the last column of the top row meets the terrain top.
    for (const int column : {0, 320, 639}) {
      const glm::dvec3 d = f.direction(column, 0);
      const double right = kappa * d.x / -d.y;
      EXPECT_NEAR(right, -half_width + (column + 0.5) * 2 * half_width / 640, 1e-9 * b.r_max_m);
    }
    // The far edge of the sensor lies at the farthest ground range.
    const glm::dvec3 d = f.direction(0, -0.5);
    EXPECT_NEAR(kappa * d.z / -d.y, g_max, 1e-9 * b.r_max_m);
  });
}

TEST(FrustumProjection, HoldsEveryPointOfTheSector) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  int frusta = 0;
  const int refused = for_each_frustum([&](const Box& b, double sector, const PerspectiveFrustum& f) {
    ++frusta;
    const glm::dmat4 clip_from_antenna = f.clip_from_camera() * f.camera_from_antenna();
    for (int n = 0; n < 4000; ++n) {
      // One in four on each of the extremes: edges of the sector, of the swath, of the box.
      const auto extreme = [&] {
        const double u = unit(random);
        return u < 0.25 ? 0.0 : u < 0.5 ? 1.0 : unit(random);
      };
      const double azimuth = sector * (extreme() - 0.5);
      const double below = b.above_bottom_m - b.height_m * extreme();
      const double r = b.r_min_m + (b.r_max_m - b.r_min_m) * extreme();
      if (r < below) continue;
      const double g = std::sqrt(r * r - below * below);
      const glm::dvec4 clip =
          clip_from_antenna * glm::dvec4(g * std::sin(azimuth), -below, g * std::cos(azimuth), 1);
      // 1e-9 of the screen is a millionth of a pixel.
      ASSERT_GT(clip.w, 0) << b.above_bottom_m << " " << sector / kDegree_rad;
      EXPECT_LE(std::abs(clip.x), clip.w * (1 + 1e-9))
          << b.above_bottom_m << " " << sector / kDegree_rad << " " << static_cast<int>(f.kind);
      EXPECT_LE(std::abs(clip.y), clip.w * (1 + 1e-9))
          << b.above_bottom_m << " " << sector / kDegree_rad << " " << static_cast<int>(f.kind);
      if (testing::Test::HasFailure()) return;
    }
  });
  std::printf("    %d frusta, %d symmetric ones refused\n", frusta, refused);
}

struct Tally {
  int rays = 0, by_embree = 0, hits = 0, on_buildings = 0, repaired = 0, differ = 0;
  double worst_m = 0;
};

void compare(const ScenePlan& plan, AzimuthRange range, const std::string& scene_text, Tally& tally) {
  const glm::dvec3& antenna = plan.sector().antenna_m;
  FirstHits trace(plan, range);
  const auto source = make_ray_source(plan, range);
  if (!source) return;  // no ground in the sector
  const auto rays = std::make_unique<RayBatch>();
  std::vector<RoughHit> rough(kBatch);
  while (source && source->generate(*rays)) {
    trace.trace(*rays, rough.data());
    for (std::size_t k = 0; k < static_cast<std::size_t>(rays->n); ++k) {
      const glm::dvec3 direction(rays->dir_x[k], rays->dir_y[k], rays->dir_z[k]);
      const auto walked = first_hit(plan.scene(), antenna, direction);
      const bool sure = rough[k].kind == RoughHit::Kind::none && !trace.by_embree(k);
      const RayAnswer answer = sure ? RayAnswer{} : answer_ray(plan.scene(), antenna, direction, rough[k]);
      ++tally.rays;
      tally.by_embree += trace.by_embree(k) ? 1 : 0;
      const double expected_m = walked ? walked->slant_range_m : HUGE_VAL;
      const double found_m = answer.hit ? answer.hit->slant_range_m : HUGE_VAL;
      // Beyond the swath nothing is binned, and buildings are not looked for.
      if (std::min(expected_m, found_m) > plan.sector().r_max_m) continue;
      ++tally.hits;
      tally.on_buildings += walked && walked->face != kNoFace ? 1 : 0;
      tally.repaired += answer.repaired ? 1 : 0;
      if (const double off_m = std::abs(expected_m - found_m); off_m > 1e-6) {
        if (++tally.differ <= 5)
          std::printf("    direction (%.12f, %.12f, %.12f): walked %.9f m, %s %.9f m, in %s\n", direction.x,
                      direction.y, direction.z, expected_m, trace.by_embree(k) ? "by Embree" : "marched",
                      found_m, scene_text.c_str());
      } else {
        tally.worst_m = std::max(tally.worst_m, off_m);
      }
    }
  }
}

Tally tally_of(FrustumKind kind) {
  Tally tally;
  for (std::uint64_t seed = 31000; seed < 31600; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    const auto scene = test::scene_of(random);
    random.settings.frustum = kind;
    const auto planned = plan_frame(scene, test::snapshot(random.settings), random.pose);
    if (!planned.plan) continue;  // from here this camera cannot look
    const int n = random.settings.azimuth_bins;
    for (int first = 0; first < n; first += 8)
      compare(planned.plan->looks_at(), {first, std::min(8, n - first)}, random.text, tally);
  }
  std::printf(
      "    %d rays (%d by Embree), %d hits in the swath (%d on buildings), %d beside silhouettes, %d differ; "
      "within %.1e m\n",
      tally.rays, tally.by_embree, tally.hits, tally.on_buildings, tally.repaired, tally.differ,
      tally.worst_m);
  // Only rays that meet an edge or a silhouette to rounding may take its other side.
  EXPECT_LE(tally.differ, tally.hits / 20000);
  EXPECT_LT(tally.worst_m, 1e-6);
  return tally;
}

TEST(MarchedRays, OfTheObliqueFrustumMeetWhatTheirOwnWalksMeet) {
  const Tally tally = tally_of(FrustumKind::oblique);
  EXPECT_GT(tally.hits, 20000);
  EXPECT_GT(tally.on_buildings, 300);
  EXPECT_LT(tally.by_embree, tally.rays / 2);
}

TEST(MarchedRays, OfOneAzimuthBinAllAroundMeetAHillOnEitherSide) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::cone, 9000, 30);
  spec.terrain.shape.height_m = 800;
  spec.terrain.shape.width_m = 600;
  spec.terrain.shape.distance_m = 5000;
  const auto scene = test::make_scene(load_world(spec));
  RadarSettings settings =
      test::radar_settings(FrustumKind::oblique, {1100, 8000, 360}, {1, 256}, {256, 256});
  Tally tally;
  for (const double bearing_deg : {0.0, 60.0, 120.0, 180.0, 240.0, 300.0}) {
    const auto planned = plan_frame(scene, test::snapshot(settings),
                                    test::pose_over_origin(scene->world(), 1000, bearing_deg));
    ASSERT_TRUE(planned.plan) << all_text(planned.errors);
    compare(planned.plan->looks_at(), {0, 1}, "a cone, 360 degrees in one bin", tally);
  }
  EXPECT_GT(tally.hits, 10000);
  EXPECT_EQ(tally.differ, 0);
}

TEST(PixelsOfBins, AllAroundNoneTakesWhatIsItsNeighbours) {
  // Edges that rounding puts beside 90 degrees leave no sliver of a bin that takes whole rows.
  const auto scene = test::level_ground();
  for (const int azimuth_bins : {8, 36, 100, 160, 193, 200, 360}) {
    const RadarSettings settings =
        test::radar_settings(FrustumKind::oblique, {2000, 8000, 360}, {azimuth_bins, 32}, {400, 500});
    const Frame frame = render(scene, test::snapshot(settings),
                               test::pose_over_origin(scene->world(), 1000, 0), {0, azimuth_bins}, {});
    std::vector<double> samples;
    for (int a = 0; a < azimuth_bins; ++a) {
      double sum = 0;
      for (int r = 0; r < 32; ++r) sum += frame.bins.count[static_cast<std::size_t>(a * 32 + r)];
      samples.push_back(sum);
    }
    for (std::size_t a = 0; a < samples.size(); ++a) {
      const double beside = samples[(a + 1) % samples.size()];
      EXPECT_LT(samples[a], 2.5 * beside + 40) << a << " of " << azimuth_bins;
      EXPECT_LT(beside, 2.5 * samples[a] + 40) << a << " of " << azimuth_bins;
    }
  }
}

TEST(MarchedRays, OfTheSymmetricFrustumMeetWhatTheirOwnWalksMeet) {
  const Tally tally = tally_of(FrustumKind::symmetric);
  EXPECT_GT(tally.hits, 20000);
  EXPECT_GT(tally.on_buildings, 200);
  EXPECT_LT(tally.by_embree, tally.rays / 2);
}

}  // namespace
}  // namespace obliq::frustum_test
