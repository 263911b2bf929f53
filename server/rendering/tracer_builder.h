#pragma once
#include <future>
#include <memory>
#include <mutex>
#include <string>

namespace obliq {

class Scene;

namespace net {

/// Builds scenes' tracers on a thread of its own, one at a time, so that radars that need none go on
/// meanwhile. From any thread.
class TracerBuilder {
 public:
  enum class State { built, building, failed };

  /// Begins to build unless that is done or under way, and waits for the end for a moment. What has failed is
  /// tried again by the next call.
  State ensure(const std::shared_ptr<const Scene>& scene, std::string& fault);

 private:
  std::mutex mutex_;  ///< guards both
  std::shared_ptr<const Scene> scene_;
  std::shared_future<std::string> end_;  ///< of building scene_: what was wrong
};

}  // namespace net
}  // namespace obliq
