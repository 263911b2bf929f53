#pragma once
#include <future>
#include <memory>
#include <mutex>
#include <string>

namespace obliq {

class Scene;

namespace net {

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

}  // namespace net
}  // namespace obliq
