// The first frustum whose rays are traced, while others sweep.
#include "server/rendering/scene_renderer.h"

#include <gtest/gtest.h>

#include "tests/support/small_settings.h"

namespace obliq {
namespace {

TEST(SceneRenderer, SweepsGoOnWhileTheRayTracersSceneIsBuilt) {
  // Four million posts: no machine builds them in the moment that plan() waits.
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 20000, 20)),
                                      test::two_materials(), RayMethod::embree);
  const net::SceneRenderer renderer(scene, "flat");
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
  const net::SceneRenderer renderer(scene, "flat");
  for (const FrustumKind kind : {FrustumKind::oblique, FrustumKind::symmetric})
    EXPECT_TRUE(renderer.plan(test::small_settings(kind), test::settings_over_origin(2000)).frame);
  EXPECT_EQ(scene->built_tracer(), nullptr);
}

TEST(SceneRenderer, WhatCannotBePlannedBuildsNothing) {
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 10000, 50)),
                                      test::two_materials(), RayMethod::embree);
  const net::SceneRenderer renderer(scene, "flat");
  EXPECT_FALSE(renderer.plan(test::small_settings(FrustumKind::oblique), test::settings_over_origin(-10))
                   .errors.empty())
      << "below the ground";
  EXPECT_EQ(scene->built_tracer(), nullptr);
}

}  // namespace
}  // namespace obliq
