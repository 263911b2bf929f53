#include "server/rendering/tracer_builder.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>

#include "server/scene/scene.h"
#include "server/scene/scene_memory.h"
#include "terrain/base/errors.h"

namespace obliq::net {
namespace {

/// Other radars may wait this long for their turn.
constexpr std::chrono::milliseconds kMoment{5};

std::string build(const std::shared_ptr<const Scene>& scene) {
  spdlog::info("a frustum needs traced rays: building the ray-tracing scene");
  try {
    scene->tracer();
  } catch (const std::exception& error) {
    return failure_text(error);
  }
  spdlog::info("{}", tracer_line(*scene));
  spdlog::info("{}", memory_line(*scene));
  return {};
}

}  // namespace

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

}  // namespace obliq::net
