#pragma once
#include <functional>
#include <string>
#include <vector>

#include "server/explain/explanation.h"
#include "server/scene/ray_method.h"
#include "terrain/base/progress.h"
#include "terrain/world_spec.h"

namespace obliq {

struct ExplainInput {
  std::string scene;
  std::string radar;
  WorldSpec world;
  std::vector<Material> materials;
  RadarSettings settings;
  PoseSettings pose;
  int threads = 0;  ///< 0: all cores
  RayMethod rays = RayMethod::march;
  std::function<void(const World&)> on_loaded;  ///< told of the scene as it is, before anything is changed
};

/// Renders some wedges of the scene as it is and with one ingredient after the other changed, one changed
/// world in memory at a time. Throws InputError when the scene itself cannot be loaded or rendered; a change
/// that cannot is a comparison with a reason.
Explanation explain_scene(const ExplainInput& input, const Progress& progress = {});

}  // namespace obliq
