#pragma once
#include <memory>
#include <string>

#include "server/net/frame_renderer.h"

namespace obliq::net {

/// Renders frames of a loaded scene.
class SceneRenderer : public FrameRenderer {
 public:
  SceneRenderer(std::shared_ptr<const Scene> scene, std::string scene_name);
  std::vector<FieldError> place(const PoseSettings& pose) const override;
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override;

 private:
  std::shared_ptr<const Scene> scene_;
  std::string scene_name_;
};

}  // namespace obliq::net
