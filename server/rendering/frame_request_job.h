#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>

#include "server/rendering/job.h"

namespace obliq::rendering {

/// Renders the frames of all RenderOnce requests. Clients take turns, slice by slice; a client's frames come
/// one after the other, in the order of its requests. The next slice of a frame waits until its client has
/// taken enough of it, without a thread.
class FrameRequestJob : public Job {
 public:
  explicit FrameRequestJob(const RenderContext& context);
  ~FrameRequestJob() override;

  // From any thread:
  void enqueue(FrameRequestPtr request);
  void stop();

  /// True: no request is left that could be rendered.
  bool is_empty() const;
  /// Aborts all frames.
  void give_up();
  Time date(Time now) override;
  bool work() override;

 private:
  struct Frame;
  using FramePtr = std::shared_ptr<Frame>;
  std::map<std::uint64_t, FramePtr> first_of_clients() const;
  FramePtr next_ready();
  bool is_ready(const Frame& frame, int parked) const;
  int parked() const;
  bool has_ended(const Frame& frame) const;
  /// Plans the frame, which may not be possible yet, or renders a slice; true: there is more to come.
  bool work_on(Frame& frame) const;
  bool begin(Frame& frame) const;
  bool render_slice(Frame& frame) const;

  const RenderContext& context_;
  mutable std::mutex mutex_;  ///< guards the queue; the frames in it are the render thread's
                              ///< and their own work's alone
  std::deque<FramePtr> queue_;
  std::uint64_t last_client_ = 0;  ///< whose turn was the last
};

}  // namespace obliq::rendering
