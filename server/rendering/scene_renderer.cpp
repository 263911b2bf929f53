#include "server/rendering/scene_renderer.h"

#include <chrono>
#include <exception>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/log/log.h"
#include "server/output/describe_frame.h"
#include "server/output/describe_targets.h"
#include "server/radar/frame_plan.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/render.h"
#include "server/scene/scene.h"
#include "server/scene/scene_memory.h"
#include "terrain/base/errors.h"

namespace obliq::rendering {
namespace {

/// Other radars may wait this long for their turn.
constexpr std::chrono::milliseconds kMoment{5};

std::string build(const std::shared_ptr<const Scene>& scene) {
  log_info("a frustum needs traced rays: building the ray-tracing scene");
  try {
    scene->tracer();
  } catch (const std::exception& error) {
    return failure_text(error);
  }
  log_info("{}", tracer_line(*scene));
  log_info("{}", memory_line(*scene));
  return {};
}

class PlannedSceneFrame : public PlannedFrame {
 public:
  PlannedSceneFrame(std::shared_ptr<const Scene> scene, std::shared_ptr<const FramePlan> plan,
                    std::string scene_name, std::string build)
      : scene_(std::move(scene)),
        plan_(std::move(plan)),
        scene_name_(std::move(scene_name)),
        build_(std::move(build)) {}

  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  const FramePlan& plan() const { return *plan_; }

  void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const override {
    describe_frame(*plan_, radar, scene_name_, descriptor);
    descriptor.set_build(build_);
  }
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    return render_wedges(*plan_, azimuths, options);
  }
  std::optional<RenderedTrain> render_train(const TrainLook& look,
                                            const RenderOptions& options) const override {
    return obliq::render_train(scene_, *plan_, look, options);
  }
  std::unique_ptr<const TargetEchoes> targets(AzimuthRange azimuths,
                                              const RenderOptions& options) const override {
    if (options.targets == nullptr) return nullptr;
    return std::make_unique<const TargetEchoes>(*plan_, air(), *options.targets, azimuths,
                                                target_look(options));
  }
  std::vector<wire::TargetRecord> truth(AzimuthRange azimuths, const RenderOptions& options,
                                        double noise_power_w) const override {
    if (options.targets == nullptr) return {};
    const TargetEchoes echoes(*plan_, air(), *options.targets, azimuths, target_look(options, true));
    return target_records(*plan_, echoes.truth(), noise_power_w);
  }
  void summarise(const FrameStats& stats, wire::FrameSummary& summary) const override {
    summarise_frame(*plan_, stats, summary);
  }
  AirView air() const override { return air_view(plan_->looks_at()); }
  std::vector<std::uint32_t> seen() const override { return plan_->looks_at().seen().list(); }
  void see_again(const std::vector<std::uint32_t>& buildings) const override {
    plan_->looks_at().seen().mark(buildings);
  }
  std::unique_ptr<PlannedFrame> again(const PoseSettings& pose) const override {
    return std::make_unique<PlannedSceneFrame>(scene_, plan_->again(pose), scene_name_, build_);
  }

 private:
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const FramePlan> plan_;
  std::string scene_name_, build_;
};

}  // namespace

SceneRenderer::SceneRenderer(std::shared_ptr<const Scene> scene, std::string scene_name, std::string build)
    : scene_(std::move(scene)), scene_name_(std::move(scene_name)), build_(std::move(build)) {}

std::shared_ptr<const Scene> SceneRenderer::scene() const {
  const std::lock_guard lock(mutex_);
  return scene_;
}

void SceneRenderer::replace(std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(mutex_);
  ++generation_;
  scene_.swap(scene);  // the old one is freed after the lock
}

std::string SceneRenderer::scene_hash() const { return obliq::scene_hash(*scene()); }

std::vector<FieldError> SceneRenderer::place(const PoseSettings& pose) const {
  std::vector<FieldError> errors;
  (void)place_antenna(scene()->world(), pose, errors);
  return errors;
}

std::vector<FieldError> SceneRenderer::scene_faults(const RadarSettings& settings) const {
  return flat_plate_faults(settings, scene()->materials());
}

std::vector<FieldError> SceneRenderer::faults(const RadarSettings& settings, const PoseSettings& pose) const {
  const auto here = scene();
  std::vector<FieldError> errors;
  const auto placed = place_antenna(here->world(), pose, errors);
  return placed ? beam_faults(here, settings, *placed) : errors;
}

FrameRenderer::Plan SceneRenderer::plan(const SettingsPtr& settings, const PoseSettings& pose) const {
  return plan_in(scene(), settings, pose, nullptr);
}

FrameRenderer::Plan SceneRenderer::plan_again(const PlannedFrame& frame, const SettingsPtr& settings,
                                              const PoseSettings& pose) const {
  const auto& before = dynamic_cast<const PlannedSceneFrame&>(frame);
  return plan_in(before.scene(), settings, pose, &before.plan());
}

FrameRenderer::Plan SceneRenderer::plan_in(std::shared_ptr<const Scene> scene, const SettingsPtr& settings,
                                           const PoseSettings& pose, const FramePlan* before) const {
  Plan result;
  const auto placed = place_antenna(scene->world(), pose, result.errors);
  if (!placed) return result;
  PlanResult planned = plan_frame(scene, settings, *placed);
  result.errors = std::move(planned.errors);
  if (!planned.plan) return result;
  if (needs_tracer(*scene, settings->settings.frustum)) {
    std::string fault;
    const TracerBuilder::State state = tracer_.ensure(scene, fault);
    if (state == TracerBuilder::State::failed)
      result.errors = {{"frustum.kind", "a frustum whose rays are traced", "\"sweep\": " + fault}};
    if (state != TracerBuilder::State::built) return result;
  }
  if (before != nullptr)
    planned.plan->looks_at().seen().mark(before->looks_at().seen().list());  // the dwells of a pass add up
  result.frame =
      std::make_unique<PlannedSceneFrame>(std::move(scene), std::move(planned.plan), scene_name_, build_);
  return result;
}

TracerBuilder::State TracerBuilder::ensure(const std::shared_ptr<const Scene>& scene, std::string& fault) {
  if (scene->built_tracer() != nullptr) return State::built;
  std::unique_lock lock(mutex_);
  if (!end_.valid()) {
    scene_ = scene;
    end_ = std::async(std::launch::async, build, scene).share();
  }
  const std::shared_ptr<const Scene> built = scene_;
  const std::shared_future<std::string> end = end_;
  lock.unlock();
  if (end.wait_for(kMoment) != std::future_status::ready) return State::building;
  lock.lock();
  if (scene_ == built) {
    scene_ = nullptr;
    end_ = {};
  }
  if (built != scene) return State::building;
  fault = end.get();
  return fault.empty() ? State::built : State::failed;
}

}  // namespace obliq::rendering
