#pragma once
// The recorded time as it flows for all who watch a replay: pause, speed, jumps.
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace obliq {

/// In nanoseconds, as RecordedTime counts them. For several threads.
class PlaybackClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// Stands at 0 until a client watches. speed: recorded seconds in a second; infinity: everything is due at
  /// once.
  explicit PlaybackClock(double speed) : speed_(speed) {}

  void set_speed(double speed);
  void set_paused(bool paused);
  void set_watched(bool watched);
  double speed() const;
  bool is_paused() const;
  bool runs() const;

  /// Where it is; at infinite speed the newest time that was waited for.
  std::int64_t now_ns() const;
  /// Is there from now on; waits that name an earlier number of jumps end with `jumped`.
  void jump(std::int64_t to_ns);
  /// Is there from now on, as nothing could be shown meanwhile; waits go on.
  void set_back(std::int64_t to_ns);
  std::uint64_t jumps() const;

  enum class Outcome {
    reached,
    jumped,  ///< jumps() is no longer what the caller knows
    stopped,
    not_yet,  ///< after `most`
  };
  Outcome wait_until(std::int64_t at_ns, std::uint64_t jumps, const std::stop_token& stop,
                     Clock::duration most);

 private:
  bool flows() const { return watched_ && !paused_; }
  std::int64_t read() const;
  void anchor();
  template <class Value>
  void change(Value& value, Value to);

  mutable std::mutex mutex_;  ///< guards everything below
  std::condition_variable_any changed_;
  double speed_;
  bool paused_ = false;
  bool watched_ = false;
  std::uint64_t jumps_ = 0;
  std::uint64_t changes_ = 0;
  std::int64_t anchor_ns_ = 0;  ///< was read at
  Clock::time_point anchored_ = Clock::now();
  std::int64_t reached_ns_ = 0;
};

}  // namespace obliq
