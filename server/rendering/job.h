#pragma once
// What the render thread chooses from, and what all jobs share.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <stop_token>
#include <vector>

#include "server/radar/render.h"
#include "server/radar/targets/target.h"
#include "server/rendering/frame_renderer.h"
#include "server/rendering/parked_work.h"
#include "server/rendering/render_events.h"

namespace obliq::rendering {

/// Work of the render thread, done piece by piece. For that thread alone.
class Job {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  virtual ~Job() = default;
  /// When there is a piece to render: now, or that late; Time::max(): not before something changes.
  virtual Time date(Time now) = 0;
  /// Renders the piece until it is done or its turn is over. True when it is done.
  virtual bool work() = 0;
};

struct RenderThreadOptions {
  int threads = 0;
  std::size_t slice_bytes = std::size_t{16} << 20;
  /// Of a RenderOnce frame, in units of ask() (terrain/base/asking.h), before another client's has its turn:
  /// about a second of a core; a few milliseconds where an antenna scans.
  std::int64_t once_work = 200'000'000;
  std::int64_t once_work_while_scanning = 2'000'000;
  int live_frames = 3;  ///< of one radar: rendered or not, as long as some of it waits for a client
  std::int64_t look = WorkGate::kLook;  ///< as WorkGate::look, for tests
  /// What time it is, for tests; empty: the steady clock. When it has jumped, wake() tells the thread.
  std::function<std::chrono::steady_clock::time_point()> clock{};
};

/// A turn is no shorter, whatever changes: each costs threads that go to sleep and wake up.
constexpr std::chrono::milliseconds kShortestTurn{5};
/// Dwells of a scan have a date: in this time one is not interrupted.
constexpr std::chrono::milliseconds kShortestDwell{50};

/// The targets of the world, as the next frame is to see them. From any thread.
class CurrentTargets {
 public:
  void set(TargetsPtr targets) {
    const std::lock_guard lock(mutex_);
    targets_.swap(targets);  // the old ones are freed after the lock
  }
  TargetsPtr get() const {
    const std::lock_guard lock(mutex_);
    return targets_;
  }

 private:
  mutable std::mutex mutex_;
  TargetsPtr targets_;  ///< null: none
};

/// What the jobs of one render thread share. Written by that thread while nothing is rendered or all of it is
/// parked; read by the rendering's threads too.
struct RenderContext {
  const FrameRenderer& renderer;
  RenderEvents& events;
  const RenderThreadOptions options;

  std::atomic<std::uint64_t> changes = 0;  ///< counts what others have told the thread; from any thread
  CurrentTargets targets{};

  // Of this round:
  bool finishing = false;  ///< no frame is begun any more
  bool scanning = false;   ///< some antenna scans: slices of other work are short
  // Of the current turn:
  Job::Time turn_began{};
  Job::Time turn_ends = Job::Time::max();
  std::uint64_t changes_seen = 0;

  Job::Time now() const { return options.clock ? options.clock() : Job::Clock::now(); }
  /// Asked while a job renders, from any thread: another job is to have its turn.
  bool gives_way() const;
  /// Lets a job's work go on until it has ended, then true, or gives way: not before `least`, and in any case
  /// after so much work.
  bool turn(ParkedWork& work, std::chrono::milliseconds least = {},
            std::int64_t most_work = std::numeric_limits<std::int64_t>::max()) const;
  /// What rendering has in common for all jobs.
  RenderOptions render_options(bool iq, bool states, std::stop_token stop) const;
};

/// Of the server's monotonic clock.
std::int64_t in_nanoseconds(Job::Time time);

/// Says that a frame could not be rendered for lack of memory, or of another resource of the machine.
std::vector<FieldError> memory_failure(const std::exception& failure);

}  // namespace obliq::rendering
