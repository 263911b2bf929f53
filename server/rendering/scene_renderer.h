#pragma once
#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <string>

#include "server/rendering/frame_renderer.h"

namespace obliq::rendering {

/// Builds the tracers of scenes on its own thread, one at a time, so that radars that need none go on
/// meanwhile. From any thread.
class TracerBuilder {
 public:
  enum class State { built, building, failed };

  /// Begins to build unless that is done or under way, and waits a moment for the end. The next call tries
  /// again what has failed.
  State ensure(const std::shared_ptr<const Scene>& scene, std::string& fault);

 private:
  std::mutex mutex_;  ///< guards both
  std::shared_ptr<const Scene> scene_;
  std::shared_future<std::string> end_;  ///< of building scene_: what was wrong
};

/// Renders frames of a loaded scene, which may be replaced between frames: a planned frame keeps its scene.
/// When a frustum first needs traced rays, plan() has nothing yet until Embree's scene is built, in parallel
/// to the rendering.
class SceneRenderer : public FrameRenderer {
 public:
  /// build: of the program, for descriptors.
  SceneRenderer(std::shared_ptr<const Scene> scene, std::string scene_name, std::string build = {});
  std::vector<FieldError> place(const PoseSettings& pose) const override;
  std::vector<FieldError> scene_faults(const RadarSettings& settings) const override;
  std::vector<FieldError> faults(const RadarSettings& settings, const PoseSettings& pose) const override;
  std::string scene_hash() const override;
  std::uint64_t generation() const override { return generation_; }
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override;
  Plan plan_again(const PlannedFrame& frame, const SettingsPtr& settings,
                  const PoseSettings& pose) const override;

  // From any thread:
  std::shared_ptr<const Scene> scene() const;
  void replace(std::shared_ptr<const Scene> scene);

 private:
  Plan plan_in(std::shared_ptr<const Scene> scene, const SettingsPtr& settings, const PoseSettings& pose,
               const FramePlan* before) const;

  mutable std::mutex mutex_;  ///< guards scene_
  std::shared_ptr<const Scene> scene_;
  std::string scene_name_, build_;
  std::atomic<std::uint64_t> generation_ = 0;
  mutable TracerBuilder tracer_;
};

}  // namespace obliq::rendering
