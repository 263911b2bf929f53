#pragma once
// One thread chooses which job renders next: live radars at the rate asked for, slices of RenderOnce frames
// between them. The rendering itself uses as many threads as it was given.
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/rendering/appraisal_job.h"
#include "server/rendering/demand.h"
#include "server/rendering/fair_share.h"
#include "server/rendering/frame_request_job.h"
#include "server/rendering/live_job.h"
#include "server/rendering/live_stream.h"
#include "server/rendering/scan_job.h"

namespace obliq::rendering {

/// Locks: other threads talk to a job through what that job guards itself, then tell the thread that
/// something has changed. No lock is held while anything is rendered or while two classes talk.
class RenderThread {
 public:
  RenderThread(const FrameRenderer& renderer, RenderEvents& events, RenderThreadOptions options);
  ~RenderThread();  // end()s

  /// Before start(). Radars are numbered in the order they are added.
  void add_radar(const std::string& name, std::uint32_t stream_id, LiveView view);
  void start();
  /// Begins no further frame; those that have begun are rendered to their ends, then on_finished() is called.
  void finish();
  /// Begins no further frame, and gives up those that have begun after their current wedges.
  void stop();
  /// stop(), and waits for the thread.
  void end();

  // From any thread:
  void set_view(std::size_t radar, LiveView view);
  /// None: no client watches; the current frame is given up.
  void set_demand(std::size_t radar, std::vector<Demand> demands);
  /// Total freeze of all radars: see LiveStream::hold.
  void hold(bool on);
  /// From the next frame on, of a scan from the next dwell on. Null: none.
  void set_targets(TargetsPtr targets) { context_.targets.set(std::move(targets)); }
  void enqueue(FrameRequestPtr request);
  void enqueue(AppraisalPtr appraisal);
  /// A client has taken bytes, or a request was cancelled.
  void wake();
  LiveStream::Load load(std::size_t radar) const { return radars_[radar].stream.load(); }

 private:
  using Time = Job::Time;

  struct Radar {
    Radar(RenderContext& context, std::size_t number, const std::string& name, std::uint32_t stream_id,
          LiveView view, std::function<void()> on_freed);

    LiveStream stream;
    LiveJob frames;
    ScanJob scan;
  };
  /// A job that was chosen, and its number in shares_.
  struct Turn {
    Job* job = nullptr;
    std::size_t flow = 0;
  };

  void run(const std::stop_token& stop);
  /// Notes what the thread has been told so far.
  void begin_round();
  /// Ends scans that no client wants any more.
  void end_scans();
  /// The job whose turn it is; empty: none before next_due.
  std::optional<Turn> choose(Time now, Time& next_due);
  /// Lets the job work, and charges it for the time.
  void take(const Turn& turn);
  void wait(const std::stop_token& stop, Time until);

  RenderContext context_;
  std::deque<Radar> radars_;  ///< a deque: elements stay where they are
  FrameRequestJob requests_;
  AppraisalJob appraisals_;
  FairShare shares_;  ///< live radars by their numbers, then RenderOnce, then appraisals

  std::mutex mutex_;  ///< guards finishing_, and that context_.changes does not change unseen
  std::condition_variable_any changed_;
  bool finishing_ = false;
  std::uint64_t seen_ = 0;  ///< context_.changes when the round began

  std::jthread thread_;
};

}  // namespace obliq::rendering
