#pragma once
#include <mutex>
#include <string>

namespace obliq::http {

/// How far the daemon is, for /readyz. From any thread.
class Readiness {
 public:
  enum class Phase { loading, ready, stopping };
  struct State {
    Phase phase = Phase::loading;
    std::string stage = "starting";  ///< of loading
    double fraction = 0;             ///< of the stage
  };

  /// Without effect once stopping.
  void loading(const std::string& stage, double fraction) { set({Phase::loading, stage, fraction}); }
  void ready() { set({Phase::ready, "", 1}); }
  void stopping() { set({Phase::stopping, "", 0}); }
  State state() const {
    const std::lock_guard lock(mutex_);
    return state_;
  }

 private:
  void set(State state) {
    const std::lock_guard lock(mutex_);
    if (state_.phase != Phase::stopping) state_ = std::move(state);
  }
  mutable std::mutex mutex_;
  State state_;
};

}  // namespace obliq::http
