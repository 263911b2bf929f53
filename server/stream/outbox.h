#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "server/stream/frame_queue.h"
#include "server/stream/live_frames.h"

namespace obliq::stream {

/// What waits to be written to one client: control messages, then frames, one queue per stream. Bounded, but
/// for control messages, which the caller limits. Knows no sockets. For one thread.
class Outbox {
 public:
  Outbox(int frames_per_queue, std::size_t live_bytes)
      : frames_per_queue_(frames_per_queue), live_bytes_(live_bytes) {}
  ~Outbox() { clear(); }
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;

  void push_control(BlockPtr message);
  std::size_t control_size() const { return control_.size(); }

  void open_live_queue(std::uint32_t stream_id, const StreamChoice& choice,
                       QueuePolicy policy = QueuePolicy::newest_wins);
  /// Vanishes after its only frame.
  void open_once_queue(std::uint32_t stream_id, std::uint64_t request_id, const StreamChoice& choice,
                       ByteCounter counter);
  bool has_queue(std::uint32_t stream_id) const { return queue(stream_id) != nullptr; }
  /// Null when there is none; valid until a queue is opened or closed.
  const FrameQueue* queue(std::uint32_t stream_id) const;

  /// Takes a block of a frame; those of streams without a queue are ignored. See FrameQueue::push.
  void push(const BlockPtr& block, const LiveFramePtr& frame = nullptr);

  /// Gives up a frame that waits in a queue, with a FrameAbort when it has begun.
  void give_up(std::uint32_t stream_id, std::uint64_t frame_id, const std::string& reason);

  /// Drops what waits in a queue and closes it; a begun frame is ended by a FrameAbort.
  void close_queue(std::uint32_t stream_id, const std::string& reason);
  void close_all_queues(const std::string& reason);

  /// The next message to write, or null.
  BlockPtr pop();

  void clear();
  std::size_t queued_bytes() const;
  std::uint64_t frames_dropped() const;
  std::size_t queued_messages() const;  ///< control messages and blocks

 private:
  FrameQueue* find(std::uint32_t stream_id);

  int frames_per_queue_;
  std::size_t live_bytes_;  ///< of all newest-wins queues
  std::deque<BlockPtr> control_;
  std::vector<FrameQueue> queues_;
  std::size_t next_queue_ = 0;
  std::uint64_t dropped_by_closed_ = 0;
};

}  // namespace obliq::stream
