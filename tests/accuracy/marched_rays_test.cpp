// What a frustum's rays meet, found by a march, against each ray's own walk through the grid's cells and the
// buildings near it, in hundreds of thousands of rays of random scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "server/radar/rays/first_hits.h"
#include "server/radar/rays/ray_samples.h"
#include "server/scene/ray_answer.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

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
  RadarSettings settings;
  settings.sector_deg = 360;
  settings.r_min_m = 1100;
  settings.r_max_m = 8000;
  settings.azimuth_bins = 1;
  settings.range_bins = 256;
  settings.pixel_columns = settings.pixel_rows = 256;
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

TEST(MarchedRays, OfTheSymmetricFrustumMeetWhatTheirOwnWalksMeet) {
  const Tally tally = tally_of(FrustumKind::symmetric);
  EXPECT_GT(tally.hits, 20000);
  EXPECT_GT(tally.on_buildings, 200);
  EXPECT_LT(tally.by_embree, tally.rays / 2);
}

}  // namespace
}  // namespace obliq
