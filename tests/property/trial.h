#pragma once
// One random scene, built, and frames of it.
#include <optional>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scatterer_shares.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq::test {

struct Trial {
  std::shared_ptr<const Scene> scene;
  Pose pose;
  RadarSettings settings;
  std::string text;

  /// Both materials have constant gamma, so that powers can be worked out by hand.
  explicit Trial(std::uint64_t seed, const RandomSceneOptions& options = {})
      : Trial(random_scene(seed, options)) {}
  explicit Trial(RandomScene random, std::vector<Material> materials = constant_gamma_materials())
      : pose(random.pose), settings(random.settings), text(std::move(random.text)) {
    scene = std::make_shared<const Scene>(std::make_shared<const World>(std::move(random.world)),
                                          std::move(materials), 1);
  }

  /// The plan for a source; null where its frustum cannot look from this pose or at this sector.
  std::shared_ptr<const FramePlan> plan(const RadarSettings& s) const {
    if (s.frustum == FrustumKind::symmetric && s.sector_deg >= 180) return nullptr;
    return plan_frame(scene, snapshot(s), pose).plan;
  }
  RadarSettings settings_of(FrustumKind kind) const {
    RadarSettings s = settings;
    s.frustum = kind;
    return s;
  }
  Frame frame(const RadarSettings& s, int threads = 1) const {
    return frame(s, threads, {0, s.azimuth_bins});
  }
  Frame frame(const RadarSettings& s, int threads, AzimuthRange range) const {
    RenderOptions options;
    options.threads = threads;
    return render(scene, snapshot(s), pose, range, options);
  }
};

}  // namespace obliq::test
