#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>

#include "server/rendering/job.h"

namespace obliq::net {

/// Renders the frames of all RenderOnce requests. Clients take turns, slice by slice; a client's frames come
/// one after the other, in the order of its requests. The next slice of a frame waits until its client has
/// taken enough of it.
class OnceJob : public Job {
 public:
  explicit OnceJob(const RenderContext& context);
  ~OnceJob() override;

  // From any thread:
  void enqueue(OnceRequestPtr request);
  void stop();

  /// True: no request is left that could be rendered.
  bool is_empty() const;
  Time date(Time now) override;
  bool work() override;

 private:
  struct Frame;
  std::map<std::uint64_t, std::shared_ptr<Frame>> first_of_clients() const;
  std::shared_ptr<Frame> next_with_room();
  bool has_room(const Frame& frame) const;
  /// Renders a slice; true: there is more to come.
  bool work_on(Frame& frame) const;
  /// Plans the frame, which may not be possible yet; false: nothing is to come.
  bool begin(Frame& frame) const;
  bool render_slice(Frame& frame) const;

  const RenderContext& context_;
  mutable std::mutex mutex_;  ///< guards the queue; the frames in it are the render thread's alone
  std::deque<std::shared_ptr<Frame>> queue_;
  std::uint64_t last_client_ = 0;  ///< whose turn was the last
};

}  // namespace obliq::net
