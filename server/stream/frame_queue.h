#pragma once
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "server/stream/live_frames.h"

namespace obliq::stream {

/// Bytes of one stream that wait for a client: the producer adds, the queue subtracts.
using ByteCounter = std::shared_ptr<std::atomic<std::size_t>>;

enum class QueuePolicy {
  newest_wins,  ///< a frame that has not begun to be written gives way to a newer one
  lossless,     ///< keeps every frame; live frames hold the radar back
  once,         ///< the only frame of a RenderOnce; the byte counter holds its producer back
};

/// The frames of one stream on their way to one client. A frame that has begun is completed or ended by a
/// FrameAbort. For one thread.
class FrameQueue {
 public:
  using Clock = std::chrono::steady_clock;

  FrameQueue(std::uint32_t stream_id, StreamChoice choice, QueuePolicy policy, int most_frames);
  FrameQueue(FrameQueue&&) noexcept = default;
  FrameQueue& operator=(FrameQueue&&) noexcept = default;

  /// Of a once queue.
  void set_request(std::uint64_t request_id, ByteCounter counter);

  std::uint32_t stream_id() const { return stream_id_; }
  QueuePolicy policy() const { return policy_; }
  std::size_t bytes() const { return bytes_; }
  std::size_t blocks() const;

  /// Takes a block of a frame; `frame` is kept alive for as long as some of it waits here. What was not
  /// asked for and blocks of frames dropped earlier are ignored. A newest-wins frame that brings the queue
  /// above `most_bytes` is given up; when it had begun, the result is its FrameAbort, else null.
  BlockPtr push(const BlockPtr& block, const LiveFramePtr& frame, std::size_t most_bytes);

  /// The next block to write, or null.
  BlockPtr pop();

  /// A frame that waits here, in whole or in part.
  struct Held {
    std::uint64_t frame_id = 0;
    bool begun = false;
    Clock::time_point since;  ///< its FrameBegin came in
  };
  std::size_t held() const { return frames_.size(); }
  Held held(std::size_t index) const;
  /// When a block was last taken, or the first one came into the empty queue.
  Clock::time_point last_progress() const { return last_progress_; }

  /// Gives a frame up and counts it; when it had begun, the result is its FrameAbort, else null. Does
  /// nothing for a frame that is not held.
  BlockPtr give_up(std::uint64_t frame_id, const std::string& reason);
  void clear();

  /// Frames given up since the queue was opened.
  std::uint64_t dropped() const { return dropped_; }

 private:
  struct QueuedFrame {
    std::uint64_t id = 0;
    std::deque<BlockPtr> blocks;
    LiveFramePtr alive;
    Clock::time_point since;
    bool begun = false;     ///< its FrameBegin has been handed out
    bool complete = false;  ///< its last block is in
    std::uint64_t last_sequence = 0;
  };
  using Frames = std::deque<QueuedFrame>;

  bool wants(const Block& block) const;
  void begin_frame(const BlockPtr& block, const LiveFramePtr& frame);
  void enqueue(QueuedFrame& frame, const BlockPtr& block);
  void release(const Block& block);
  BlockPtr give_up(Frames::iterator at, const std::string& reason);
  void drop(Frames::iterator at);
  BlockPtr with_skipped(const BlockPtr& begin);

  std::uint32_t stream_id_;
  StreamChoice choice_;
  QueuePolicy policy_;
  std::size_t most_frames_;
  std::uint64_t request_id_ = 0;
  ByteCounter counter_;
  Frames frames_;
  std::size_t bytes_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t skipped_ = 0;  ///< since the last FrameBegin, without ever having begun
  Clock::time_point last_progress_ = Clock::now();
};

}  // namespace obliq::stream
