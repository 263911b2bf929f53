#pragma once
// The server whose session is recorded: a small scene, two radars, limits that are soon reached, and no time
// limit that is.
#include <memory>
#include <vector>

#include "server/control/sections/radar.h"
#include "server/net/options.h"
#include "server/rendering/scene_renderer.h"
#include "server/scene/scene.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test {

/// Marched: the bits depend on no version of Embree.
std::shared_ptr<const Scene> session_scene();

/// "main", and "scan", which has two dwells of 1.5 s each, so that a slow machine misses none.
std::vector<RadarConfig> session_radars();

net::ServerOptions session_options();

/// Rendering stops at the gate before the second wedge of every frame.
class GatedRenderer : public rendering::SceneRenderer {
 public:
  explicit GatedRenderer(Gate& gate) : SceneRenderer(session_scene(), "hills"), gate_(gate) {}
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override {
    return gated(SceneRenderer::plan(settings, pose));
  }
  Plan plan_again(const rendering::PlannedFrame& frame, const SettingsPtr& settings,
                  const PoseSettings& pose) const override;

 private:
  Plan gated(Plan plan) const;

  Gate& gate_;
};

}  // namespace obliq::test
