#pragma once
// A whole frame with the checks that hold for any scene.
#include <gtest/gtest.h>

#include <memory>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/samplings.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"
#include "tests/support/surface_check.h"

namespace obliq::test {

struct Rendered {
  Frame frame;
  Totals totals;
  int hits = 0;
  bool refused = false;
};

struct RenderChecks {
  int threads = 0;
  bool on_surface = true;     ///< every hit lies on the surface, by brute force
  bool none_rejected = true;  ///< every ray that met something was answered
};

/// A sane frame. Only a perspective frustum may refuse the pose, and says what is allowed.
inline Rendered rendered(const std::shared_ptr<const Scene>& scene, const RadarSettings& s, const Pose& pose,
                         const Sampling& sampling, const RenderChecks& checks = {}) {
  Rendered result;
  const PlanResult planned = plan_frame(scene, snapshot(s), pose);
  if (!planned.plan) {
    EXPECT_TRUE(sampling.rays()) << planned.errors.front().text();
    EXPECT_FALSE(planned.errors.front().allowed.empty());
    result.refused = true;
    return result;
  }
  HitsOnSurface observer(scene->world(), pose.antenna.m);
  RenderOptions options;
  if (checks.on_surface) options.observer = &observer;
  options.threads = checks.threads;
  result.frame = render(scene, snapshot(s), pose, {0, s.azimuth_bins}, options);
  result.totals = expect_sane(result.frame, s, scene->materials());
  result.hits = observer.hits;
  EXPECT_EQ(observer.wrong, 0);
  if (checks.none_rejected) {
    EXPECT_EQ(result.frame.stats.rejected, 0u);
  }
  return result;
}

}  // namespace obliq::test
