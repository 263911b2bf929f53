#pragma once
// One thread decides which frame is rendered next: live radars at the rate asked for, RenderOnce jobs slice
// by slice between them. The rendering itself uses as many threads as it was given.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/rendering/demand.h"
#include "server/rendering/fair_share.h"
#include "server/rendering/frame_renderer.h"
#include "server/rendering/live_view.h"
#include "server/rendering/rendered.h"
#include "server/stream/block.h"
#include "server/stream/frame_queue.h"
#include "server/stream/live_frames.h"
#include "server/stream/stream_choice.h"

namespace obliq::net {

struct FrameIdentity;

/// One RenderOnce request.
struct OnceJob {
  std::uint64_t client_id = 0;
  std::uint64_t request_id = 0;
  std::uint32_t stream_id = 0;
  std::string radar;  ///< echoed
  LiveView view;
  StreamChoice choice;
  FrameCost cost;
  std::stop_source stop;                                               ///< requested when its client has gone
  ByteCounter queued = std::make_shared<std::atomic<std::size_t>>(0);  ///< bytes its client has not taken
};
using OnceJobPtr = std::shared_ptr<OnceJob>;

/// Hears what happens. Called on the render thread or on the rendering's own threads, one call at a time.
class RenderEvents {
 public:
  virtual ~RenderEvents() = default;
  virtual void on_live_blocks(std::size_t radar, const LiveFramePtr& frame, std::vector<BlockPtr> blocks) = 0;
  virtual void on_live_rendered(std::size_t radar, const RenderedFrame& frame) = 0;
  /// A frame is due, and as many as may be are alive. Repeated until one has gone.
  virtual void on_live_held_up(std::size_t radar, double since_s) = 0;
  /// The radar cannot be rendered as it is; it is tried again when its view changes.
  virtual void on_live_fault(std::size_t radar, const std::shared_ptr<const LiveView>& view,
                             const std::vector<FieldError>& errors) = 0;
  virtual void on_once_block(const OnceJobPtr& job, const BlockPtr& block) = 0;
  virtual void on_once_rendered(const RenderedOnce& frame) = 0;
  /// Instead of a frame.
  virtual void on_once_fault(const OnceJobPtr& job, const std::vector<FieldError>& errors) = 0;
  /// After finish(): nothing more comes.
  virtual void on_finished() = 0;
};

struct RenderThreadOptions {
  int threads = 0;
  std::size_t slice_bytes = std::size_t{16} << 20;
  /// Of a RenderOnce job, before others get their turn (see RenderPause), however its pixels lie: as many as
  /// the paper's frame has, 2048 x 2048 pixels, within a second; a few milliseconds where an antenna scans.
  int slice_batches = 4096;
  int slice_batches_while_scanning = 128;
  int live_frames = 3;  ///< of one radar: rendered or not, as long as some of it waits for a client
  std::function<void(int)> before_wedge;
  /// What time it is, for tests; empty: the steady clock. When it has jumped, wake() tells the thread.
  std::function<std::chrono::steady_clock::time_point()> clock{};
};

struct Dwell;

class RenderThread {
 public:
  RenderThread(const FrameRenderer& renderer, RenderEvents& events, RenderThreadOptions options);
  ~RenderThread();  // end()s

  /// Before start(). Radars are numbered in the order they are added.
  void add_radar(const std::string& name, std::uint32_t stream_id, LiveView view);
  void start();
  /// Begins no further frame; those that have begun are rendered to their ends, then on_finished() is called.
  void finish();
  /// No further event is begun once this returns. The thread stops after the wedges in hand.
  void stop();
  /// stop(), and waits for the thread.
  void end();

  // From any thread:
  void set_view(std::size_t radar, LiveView view);
  /// None: nobody watches; a frame in hand is given up.
  void set_demand(std::size_t radar, std::vector<Demand> demands);
  void enqueue(OnceJobPtr job);
  /// A client has taken bytes, or a job was cancelled.
  void wake();
  /// What a radar's frames take up at present.
  struct Load {
    int live_frames = 0;
    std::size_t live_bytes = 0;
    std::uint64_t frames_skipped = 0;  ///< because of the limit of live frames
    std::uint64_t frames_shed = 0;     ///< for want of time
  };
  Load load(std::size_t radar) const;

 private:
  using Clock = std::chrono::steady_clock;

  struct ScanTask;
  struct FrameInHand;
  struct LiveTask {
    std::string name;
    std::uint32_t stream_id = 0;
    std::shared_ptr<const LiveView> view;
    std::vector<Demand> demands;
    double rate_hz = 0;  ///< the greatest
    FrameDates dates;
    Clock::time_point held_up_since = Clock::time_point::max();  ///< of a frame due; max: it is not
    Clock::time_point next_reminder;
    std::shared_ptr<LiveFrames> frames;
    std::uint64_t skipped = 0;  ///< since the newest frame
    std::atomic<std::uint64_t> skipped_in_all{0};
    std::atomic<std::uint64_t> shed{0};
    std::shared_ptr<const LiveView> faulty;  ///< what could not be rendered, if anything
    std::uint64_t faulty_generation = 0;     ///< of the renderer then
    std::uint64_t last_frame = 0;
    std::int64_t shown_pose_ns = 0;  ///< arrival of the newest pose that a whole frame has shown
    std::uint64_t sequence = 0;
    std::stop_source stop;              ///< of the frame in hand
    std::shared_ptr<FrameInHand> hand;  ///< null: none has begun; this thread alone uses it
    std::shared_ptr<ScanTask> scan;     ///< of a scanning antenna; this thread alone uses it
  };
  struct OnceTask;
  struct Choice {
    bool live = false;
    std::size_t index = 0;
    bool ends_scan = false;
  };

  void run(const std::stop_token& stop);
  bool still_faulty(const LiveTask& task) const;
  /// Whose turn it is; false: nobody's before next_due.
  bool choose(Clock::time_point now, Choice& choice, Clock::time_point& next_due);
  void take_turn(const Choice& choice, std::unique_lock<std::mutex>& lock);
  /// When a live radar has something to render: now, or that late.
  Clock::time_point live_date(std::size_t index, Clock::time_point now);
  bool is_held_up(std::size_t index, Clock::time_point now);
  /// Its frames may be late, but each is rendered.
  bool none_is_shed(const LiveTask& task) const;
  /// Asked while something is rendered: others are to have their turn.
  bool gives_way() const;
  static FrameIdentity identity_of(LiveTask& task, std::uint64_t frame_id, const Order& order,
                                   const LiveView& view);
  std::int64_t clock_ns() const;
  Clock::time_point clock_now() const { return options_.clock ? options_.clock() : Clock::now(); }

  // A scanning antenna (render_scan.cpp):
  bool wants_scan(const LiveTask& task) const;
  Clock::time_point scan_date(std::size_t index, Clock::time_point now);
  void render_dwell(std::size_t index, std::unique_lock<std::mutex>& lock);
  void leave_out(std::size_t index, const Dwell& dwell);
  void miss(ScanTask& scan, const Dwell& dwell);
  void advance(std::size_t index);
  std::vector<FieldError> begin_pass(std::size_t index, const LiveView& view,
                                     const std::vector<Demand>& demands);
  std::vector<FieldError> plan_dwell(ScanTask& scan, const LiveView& view);
  bool render_azimuths(std::size_t index, const AzimuthRange& azimuths, const LiveView& view,
                       const std::stop_token& stop);
  void end_pass(std::size_t index);
  /// Not under the lock: a frame's going is heard of under it.
  void end_scan(std::size_t index, const std::string& reason);

  /// At a frame's end. `rendered` is given its counts.
  static wire::FrameSummary summary_of(const PlannedFrame& frame, const FrameSum& stats,
                                       std::uint64_t frame_id, RenderedFrame& rendered);

  bool render_live(std::size_t index, std::unique_lock<std::mutex>& lock);
  bool begin_live(std::size_t index, std::unique_lock<std::mutex>& lock);
  bool continue_live(std::size_t index);
  void render_once(std::size_t index, std::unique_lock<std::mutex>& lock);
  bool begin_once(OnceTask& task);  ///< true without a frame: nothing yet, to be asked again
  bool continue_once(OnceTask& task);

  const FrameRenderer& renderer_;
  RenderEvents& events_;
  RenderThreadOptions options_;

  std::mutex mutex_;  ///< guards everything below but the thread
  std::condition_variable_any changed_;
  std::atomic<std::uint64_t> changes_ = 0;  ///< counts wake-ups, so that none is missed
  std::deque<LiveTask> live_;               ///< a deque: elements stay where they are
  std::deque<std::shared_ptr<OnceTask>> once_;
  bool finishing_ = false;
  RenderTurns turns_;           ///< live radars by their numbers, then RenderOnce
  std::size_t once_turn_ = 0;   ///< where the round of the RenderOnce jobs begins
  Clock::time_point give_way_;  ///< of the turn in hand, as are the next two
  Clock::time_point turn_began_;
  std::uint64_t changes_seen_ = 0;
  bool scanning_ = false;  ///< some antenna scans: slices of other work are short

  std::jthread thread_;
};

}  // namespace obliq::net
