#pragma once
#include <memory>

#include "server/explain/explanation.h"
#include "server/radar/frame_plan.h"
#include "server/scene/scene.h"

namespace obliq {

/// A world with its ray-tracing structure, ready to render.
struct LoadedScene {
  std::shared_ptr<World> world;
  std::shared_ptr<const Scene> scene;
  Pose pose;
  std::shared_ptr<const FramePlan> own;  ///< the scene's own frustum, sharp
  Costs costs;

  void take_down() {
    own = nullptr;
    scene = nullptr;
  }
};

}  // namespace obliq
