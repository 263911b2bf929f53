#pragma once
// What the render thread chooses from, and what all jobs share.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <vector>

#include "server/radar/render.h"
#include "server/rendering/frame_renderer.h"
#include "server/rendering/render_events.h"

namespace obliq::net {

/// Work of the render thread, done piece by piece. For that thread alone.
class Job {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  virtual ~Job() = default;
  /// When there is a piece to render: now, or that late; Time::max(): not before something changes.
  virtual Time date(Time now) = 0;
  /// Renders the piece until it is done or has to give way. True when it is done.
  virtual bool work() = 0;
};

struct RenderThreadOptions {
  int threads = 0;
  std::size_t slice_bytes = std::size_t{16} << 20;
  /// Of a RenderOnce frame, before others get their turn (see RenderPause), however its pixels lie: as many
  /// as the paper's frame has, 2048 x 2048 pixels, within a second; a few milliseconds where an antenna
  /// scans.
  int slice_batches = 4096;
  int slice_batches_while_scanning = 128;
  int live_frames = 3;  ///< of one radar: rendered or not, as long as some of it waits for a client
  std::function<void(int)> before_wedge;
  /// What time it is, for tests; empty: the steady clock. When it has jumped, wake() tells the thread.
  std::function<std::chrono::steady_clock::time_point()> clock{};
};

/// A turn is no shorter, whatever changes: each costs some 0.1 ms of threads that come and go.
constexpr std::chrono::milliseconds kShortestTurn{5};

/// What the jobs of one render thread share. Written by that thread while nothing is rendered; read by the
/// rendering's threads too.
struct RenderContext {
  const FrameRenderer& renderer;
  RenderEvents& events;
  const RenderThreadOptions options;

  std::atomic<std::uint64_t> changes = 0;  ///< counts what others have told the thread; from any thread

  // Of this round:
  bool finishing = false;  ///< no frame is begun any more
  bool scanning = false;   ///< some antenna scans: slices of other work are short
  // Of the turn in hand:
  Job::Time turn_began{};
  Job::Time turn_ends = Job::Time::max();
  std::uint64_t changes_seen = 0;

  Job::Time now() const { return options.clock ? options.clock() : Job::Clock::now(); }
  /// Asked while a job renders, from any thread: another job is to have its turn.
  bool gives_way() const;
  /// What rendering has in common for all jobs. `pause` may be null, else the rendering gives way.
  RenderOptions render_options(bool states, std::stop_token stop, RenderPause* pause) const;
};

/// Of the server's monotonic clock.
std::int64_t in_nanoseconds(Job::Time time);

/// Says that a frame could not be rendered for want of memory, or of another of the machine's means.
std::vector<FieldError> memory_failure(const std::exception& failure);

}  // namespace obliq::net
