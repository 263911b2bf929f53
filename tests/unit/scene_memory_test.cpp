// What a scene keeps in memory, and that Embree's part is made when rays are first cast.
#include "server/scene/scene_memory.h"

#include <gtest/gtest.h>

#include <thread>

#include "server/scene/embree_tracer.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

constexpr double kReach_m = 16000;
constexpr double kCell_m = 20;

WorldSpec hills(double per_km2) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, kReach_m, kCell_m);
  spec.terrain.shape.height_m = 600;
  if (per_km2 > 0) {
    spec.prisms.emplace_back();
    spec.prisms[0].per_km2 = per_km2;
  }
  return spec;
}

RadarSettings settings_of(FrustumKind kind) {
  RadarSettings settings;
  settings.frustum = kind;
  settings.r_min_m = 2000;
  settings.r_max_m = 8000;
  settings.pixel_columns = 128;
  settings.pixel_rows = 128;
  settings.azimuth_bins = 64;
  settings.range_bins = 64;
  return settings;
}

Frame frame_of(const std::shared_ptr<const Scene>& scene, FrustumKind kind, int threads) {
  const RadarSettings settings = settings_of(kind);
  RenderOptions options;
  options.threads = threads;
  return render(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), 2000),
                {0, settings.azimuth_bins}, options);
}

TEST(SceneMemory, APostTakesEightBytesForTheSweepAndThirtyTwoForRays) {
  const auto scene = test::make_scene(load_world(hills(0)));
  const auto posts = static_cast<double>(scene->world().grid.y_m.size());
  ASSERT_GT(posts, 2e6);
  EXPECT_LE(static_cast<double>(scene_memory(*scene).total()) / posts, 8);
  scene->tracer();
  EXPECT_LE(static_cast<double>(scene_memory(*scene).total()) / posts, 32);
  EXPECT_GE(scene_memory(*scene).tracer_peak, scene_memory(*scene).tracer);
}

TEST(SceneMemory, AWallsTriangleTakesOneHundredAndFiftyBytes) {
  const auto bare = test::make_scene(load_world(hills(0)));
  const auto built = test::make_scene(load_world(hills(80)));
  const auto walls =
      2.0 * static_cast<double>(std::ranges::count_if(built->world().buildings.faces, &BuildingFace::wall));
  ASSERT_GT(walls, 4e5);
  const auto beyond_bare = [&] {
    return static_cast<double>(scene_memory(*built).total() - scene_memory(*bare).total()) / walls;
  };
  std::printf("    %.1f bytes a wall triangle for the sweep\n", beyond_bare());
  bare->tracer();
  built->tracer();
  std::printf("    %.1f bytes a wall triangle for rays\n", beyond_bare());
  EXPECT_LE(beyond_bare(), 150);
}

TEST(SceneMemory, PlanningAndTheSweepLeaveEmbreeOut) {
  const auto scene = test::make_scene(load_world(hills(5)));
  const auto settings = test::snapshot(settings_of(FrustumKind::oblique));
  EXPECT_TRUE(plan_frame(scene, settings, test::pose_over_origin(scene->world(), 2000)).plan);
  frame_of(scene, FrustumKind::sweep, 2);
  EXPECT_EQ(scene->built_tracer(), nullptr);
  EXPECT_EQ(scene_memory(*scene).tracer, 0u);
  EXPECT_EQ(memory_line(*scene).find("Embree"), std::string::npos) << memory_line(*scene);
  frame_of(scene, FrustumKind::oblique, 2);
  EXPECT_NE(scene->built_tracer(), nullptr);
  EXPECT_NE(memory_line(*scene).find("Embree"), std::string::npos) << memory_line(*scene);
}

TEST(SceneMemory, FramesHaveTheSameBitsWhoeverBuildsTheTracer) {
  const auto world = std::make_shared<const World>(load_world(hills(5)));
  const auto early = std::make_shared<const Scene>(world, test::two_materials(), 0);
  early->tracer();
  const Frame expected = frame_of(early, FrustumKind::oblique, 1);
  const auto late = std::make_shared<const Scene>(world, test::two_materials(), 0);
  test::expect_same_bits(frame_of(late, FrustumKind::oblique, 4).bins, expected.bins);
  const auto swept = std::make_shared<const Scene>(world, test::two_materials(), 0);
  const Frame before = frame_of(swept, FrustumKind::sweep, 2);
  test::expect_same_bits(frame_of(swept, FrustumKind::oblique, 2).bins, expected.bins);
  test::expect_same_bits(frame_of(swept, FrustumKind::sweep, 2).bins, before.bins);
}

TEST(SceneMemory, SeveralRadarsAtOnceBuildOneTracer) {
  const auto scene = test::make_scene(load_world(hills(0)));
  std::vector<const EmbreeTracer*> tracers(4);
  {
    std::vector<std::jthread> radars;
    for (const EmbreeTracer*& tracer : tracers) radars.emplace_back([&] { tracer = &scene->tracer(); });
  }
  for (const EmbreeTracer* tracer : tracers) EXPECT_EQ(tracer, scene->built_tracer());
}

}  // namespace
}  // namespace obliq
