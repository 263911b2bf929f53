// Frames from where there was one before go out again, and only those.
// The first frustum whose rays are traced, while others sweep.
#include "server/rendering/frame_cache.h"

#include <gtest/gtest.h>

#include <map>

#include "proto/obliq.pb.h"
#include "server/rendering/parked_work.h"
#include "server/rendering/scene_renderer.h"
#include "terrain/base/stage_clock.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::frame_cache_test {
namespace {

constexpr AzimuthRange kAll{0, 32};

std::shared_ptr<const Scene> hills() {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 10000, 50);
  PrismSpec prisms;
  prisms.per_km2 = 3;
  spec.prisms = {prisms};
  auto scene = test::make_scene(load_world(spec));
  scene->tracer();  // or the first oblique frame would wait for it
  return scene;
}

struct CountingRenderer : rendering::SceneRenderer {
  using SceneRenderer::SceneRenderer;
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override {
    ++plans;
    return SceneRenderer::plan(settings, pose);
  }
  mutable int plans = 0;
};

class FrameCache : public testing::Test {
 protected:
  struct Result {
    std::map<int, Wedge> wedges;
    FrameStats stats;
    std::uint32_t seen = 0;
  };

  /// Plans a frame and renders azimuth bins of it; counts what scenes_ is asked for.
  Result frame(const SettingsPtr& settings, const PoseSettings& pose, bool states = true,
               AzimuthRange azimuths = kAll) {
    const auto planned = cache_.plan(settings, pose);
    Result result;
    EXPECT_TRUE(planned.frame) << all_text(planned.errors);
    if (!planned.frame) return result;
    FrameSum sum(settings->settings);
    RenderOptions options;
    options.threads = 2;
    options.states = states;
    StageTimes times;
    options.times = &times;
    options.targets = targets_.get();
    options.on_wedge = [&](Wedge&& wedge) {
      sum.add(wedge);
      result.wedges[wedge.index] = std::move(wedge);
    };
    EXPECT_TRUE(planned.frame->render(azimuths, options));
    rendered_ = times.threads() > 0;
    result.stats = sum.total();
    wire::FrameSummary summary;
    planned.frame->summarise(result.stats, summary);
    result.seen = summary.buildings_seen();
    return result;
  }

  static void expect_same(const Result& a, const Result& b) {
    ASSERT_EQ(a.wedges.size(), b.wedges.size());
    for (const auto& [index, wedge] : a.wedges) test::expect_same_bits(wedge.bins, b.wedges.at(index).bins);
    EXPECT_EQ(a.stats.rays, b.stats.rays);
    EXPECT_EQ(a.stats.samples, b.stats.samples);
    EXPECT_EQ(a.seen, b.seen);
  }

  CountingRenderer scenes_{hills(), "hills"};
  rendering::FrameCache cache_{scenes_};
  TargetsPtr targets_;
  bool rendered_ = false;  // by the last frame()
  PoseSettings pose_ = test::settings_over_origin(1500);
};

TEST_F(FrameCache, TheThirdFrameFromOnePlaceIsTheSecondOne) {
  for (const FrustumKind kind : {FrustumKind::sweep, FrustumKind::oblique}) {
    const SettingsPtr settings = test::small_settings(kind);
    const Result first = frame(settings, pose_);
    EXPECT_TRUE(rendered_);
    const std::size_t before = cache_.kept_bytes();
    frame(settings, pose_);
    EXPECT_TRUE(rendered_);
    EXPECT_EQ(cache_.kept_bytes() - before, 32u * 32u * (8 + 8 + 4 + 1));
    pose_.pose_id = 7;  // another number for the same place
    pose_.sim_time_ns = 5;
    for (int k = 0; k < 2; ++k) {
      expect_same(frame(settings, pose_), first);
      EXPECT_FALSE(rendered_);
    }
    EXPECT_GT(first.seen, 0u);
  }
}

/// Bits of a frame that a renderer without a cache makes.
TEST_F(FrameCache, TargetsMoveOverTheGroundThatIsKept) {
  Target target;
  target.id = 1;
  target.latitude_deg = pose_.latitude_deg + 0.04;
  target.longitude_deg = pose_.longitude_deg;
  target.height_m = 300;  // over the hills
  target.size.rcs_dbsm = 60;
  target.velocity_m_s = {0, 0, 100};
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  const Result bare = frame(settings, pose_);
  targets_ = std::make_shared<const TargetSet>(TargetSet{1, {target}});
  const auto differs = [&](const Result& a, const Result& b) {
    bool any = false;
    for (const auto& [index, wedge] : a.wedges)
      any = any || !test::same_bits(wedge.bins.power_w, b.wedges.at(index).bins.power_w);
    return any;
  };
  Result before = bare;
  for (int k = 0; k < 5; ++k) {
    pose_.sim_time_ns = std::int64_t{5} * k * 1'000'000'000;
    const Result cached = frame(settings, pose_);
    EXPECT_EQ(rendered_, k == 0);  // its second and third frame from there: kept since
    EXPECT_TRUE(differs(cached, before)) << k;
    const auto plan = scenes_.SceneRenderer::plan(settings, pose_);
    Result direct;
    RenderOptions options;
    options.targets = targets_.get();
    options.on_wedge = [&](Wedge&& wedge) { direct.wedges[wedge.index] = std::move(wedge); };
    EXPECT_TRUE(plan.frame->render(kAll, options));
    for (const auto& [index, wedge] : direct.wedges)
      test::expect_same_bits(wedge.bins, cached.wedges.at(index).bins);
    before = cached;
  }
  targets_ = nullptr;
  const Result again = frame(settings, pose_);
  for (const auto& [index, wedge] : again.wedges)
    test::expect_same_bits(wedge.bins, bare.wedges.at(index).bins);
}

TEST_F(FrameCache, WhatHasChangedIsRenderedAnew) {
  SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  const auto until_kept = [&] {
    for (int k = 0; k < 3; ++k) frame(settings, pose_);
    EXPECT_FALSE(rendered_);
  };
  until_kept();
  pose_.bearing_deg = 1;
  const Result turned = frame(settings, pose_);
  EXPECT_TRUE(rendered_) << "another bearing";
  EXPECT_EQ(cache_.kept_bytes(), 0u);
  until_kept();
  settings = test::small_settings(FrustumKind::sweep);
  frame(settings, pose_);
  EXPECT_TRUE(rendered_) << "another snapshot of settings";
  EXPECT_EQ(cache_.kept_bytes(), 0u);
  until_kept();
  scenes_.replace(hills());
  expect_same(frame(settings, pose_), turned);
  EXPECT_TRUE(rendered_) << "another scene";
  EXPECT_EQ(cache_.kept_bytes(), 0u);
}

TEST_F(FrameCache, NothingKeepsASceneOrSettingsThatHaveGone) {
  SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  for (int k = 0; k < 3; ++k) frame(settings, pose_);
  const std::weak_ptr<const SettingsSnapshot> old_settings = settings;
  settings = test::small_settings(FrustumKind::sweep);
  EXPECT_TRUE(old_settings.expired());
  for (int k = 0; k < 3; ++k) frame(settings, pose_);
  const std::weak_ptr<const Scene> old_scene = scenes_.scene();
  scenes_.replace(hills());
  cache_.forget();
  EXPECT_TRUE(old_scene.expired());
  EXPECT_EQ(cache_.kept_bytes(), 0u);
}

TEST_F(FrameCache, ARepeatedFrameIsNotPlannedAnewAndHasItsOwnNumber) {
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  for (int k = 0; k < 2; ++k) frame(settings, pose_);
  pose_.pose_id = 7;
  pose_.sim_time_ns = 5;
  const auto planned = cache_.plan(settings, pose_);
  wire::FrameDescriptor descriptor;
  planned.frame->describe("radar", descriptor);
  EXPECT_EQ(descriptor.pose().pose_id(), 7u);
  EXPECT_EQ(descriptor.pose().sim_time_ns(), 5);
  wire::FrameSummary summary;
  planned.frame->summarise({}, summary);
  EXPECT_EQ(summary.buildings_seen(), 0u) << "nothing of it has been rendered yet";
  EXPECT_EQ(scenes_.plans, 2);
}

TEST_F(FrameCache, PartsAreKeptAsTheyWereAskedFor) {
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  for (int k = 0; k < 3; ++k) frame(settings, pose_, false, {8, 8});
  EXPECT_FALSE(rendered_);
  frame(settings, pose_, true, {8, 8});
  EXPECT_TRUE(rendered_) << "its states were not asked for";
  frame(settings, pose_, false, {8, 8});
  EXPECT_FALSE(rendered_);
  const Result whole = frame(settings, pose_);
  EXPECT_TRUE(rendered_);
  expect_same(frame(settings, pose_), whole);
  EXPECT_FALSE(rendered_);
}

TEST_F(FrameCache, APartThatIsRepeatedHasSeenNoBuildingsOfTheOthers) {
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  const std::uint32_t alone = frame(settings, pose_, false, {16, 8}).seen;
  const auto planned = cache_.plan(settings, pose_);
  EXPECT_TRUE(planned.frame->render({0, 8}, {}));
  EXPECT_TRUE(planned.frame->render({16, 8}, {}));
  wire::FrameSummary both;
  planned.frame->summarise({}, both);
  EXPECT_GT(both.buildings_seen(), alone);
  EXPECT_EQ(frame(settings, pose_, false, {16, 8}).seen, alone);
}

TEST_F(FrameCache, AFrameThatPausesIsKeptWhole) {
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  const Result first = frame(settings, pose_);
  const auto planned = cache_.plan(settings, pose_);
  RenderOptions options;
  options.threads = 1;
  rendering::ParkedWork work([&] { EXPECT_TRUE(planned.frame->render(kAll, options)); }, {}, 0);
  int turns = 1;
  while (!work.turn([](std::int64_t) { return true; })) ++turns;
  EXPECT_GT(turns, 4);
  expect_same(frame(settings, pose_), first);
  EXPECT_FALSE(rendered_);
}

TEST_F(FrameCache, AFrameThatWasStoppedIsNotKeptAndARepeatedOneStops) {
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  frame(settings, pose_);
  std::stop_source stop;
  RenderOptions options;
  options.threads = 1;
  options.stop = stop.get_token();
  options.on_wedge = [&](Wedge&&) { stop.request_stop(); };
  EXPECT_FALSE(cache_.plan(settings, pose_).frame->render(kAll, options));
  EXPECT_EQ(cache_.kept_bytes(), 0u);
  frame(settings, pose_);
  EXPECT_TRUE(rendered_);
  EXPECT_FALSE(cache_.plan(settings, pose_).frame->render(kAll, options));
}

TEST_F(FrameCache, NoMoreIsKeptThanAllowed) {
  const rendering::FrameCache small(scenes_, 1000);
  const SettingsPtr settings = test::small_settings(FrustumKind::sweep);
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(small.plan(settings, pose_).frame->render(kAll, {}));
    EXPECT_EQ(small.kept_bytes(), 0u);
  }
}

TEST(SceneRenderer, SweepsGoOnWhileTheRayTracersSceneIsBuilt) {
  // Four million posts: no machine builds them in the moment that plan() waits.
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 20000, 20)),
                                      test::two_materials(), RayMethod::embree);
  const rendering::SceneRenderer renderer(scene, "flat");
  const PoseSettings pose = test::settings_over_origin(2000);
  EXPECT_TRUE(renderer.plan(test::small_settings(FrustumKind::sweep), pose).frame);
  EXPECT_EQ(scene->built_tracer(), nullptr);

  auto cast = renderer.plan(test::small_settings(FrustumKind::oblique), pose);
  EXPECT_FALSE(cast.frame);
  EXPECT_TRUE(cast.errors.empty()) << all_text(cast.errors);
  EXPECT_TRUE(renderer.plan(test::small_settings(FrustumKind::sweep), pose).frame);
  while (!cast.frame && cast.errors.empty())
    cast = renderer.plan(test::small_settings(FrustumKind::oblique), pose);
  EXPECT_TRUE(cast.frame) << all_text(cast.errors);
  EXPECT_NE(scene->built_tracer(), nullptr);
}

TEST(SceneRenderer, BareGroundNeedsNoRayTracer) {
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 10000, 50)));
  const rendering::SceneRenderer renderer(scene, "flat");
  for (const FrustumKind kind : {FrustumKind::oblique, FrustumKind::symmetric})
    EXPECT_TRUE(renderer.plan(test::small_settings(kind), test::settings_over_origin(2000)).frame);
  EXPECT_EQ(scene->built_tracer(), nullptr);
}

TEST(SceneRenderer, WhatCannotBePlannedBuildsNothing) {
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 10000, 50)),
                                      test::two_materials(), RayMethod::embree);
  const rendering::SceneRenderer renderer(scene, "flat");
  EXPECT_FALSE(renderer.plan(test::small_settings(FrustumKind::oblique), test::settings_over_origin(-10))
                   .errors.empty())
      << "below the ground";
  EXPECT_EQ(scene->built_tracer(), nullptr);
}

}  // namespace
}  // namespace obliq::frame_cache_test
