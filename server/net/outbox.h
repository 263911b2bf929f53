#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "server/net/block.h"

namespace obliq::net {

/// Bytes of one stream that wait for a client: the producer adds, the outbox subtracts.
using ByteCounter = std::shared_ptr<std::atomic<std::size_t>>;

/// What waits to be written to one client: control messages, then frames, one lane per stream. Bounded: in a
/// live lane the newest frame replaces the oldest that has not begun to be written, and a frame that has
/// begun is completed or ended by a FrameAbort. Knows no sockets. For one thread.
class Outbox {
 public:
  Outbox(int frames_per_lane, std::size_t live_bytes)
      : frames_per_lane_(frames_per_lane), live_bytes_(live_bytes) {}
  ~Outbox() { clear(); }
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;

  void push_control(wire::Bytes bytes);
  std::size_t control_size() const { return control_.size(); }

  /// A live lane drops and aborts frames for a slow client; one that is not live (RenderOnce) keeps all, its
  /// producer being held back through its byte counter, and vanishes after its only frame.
  void open_live_lane(std::uint32_t stream_id, wire::PlaneSet planes);
  void open_once_lane(std::uint32_t stream_id, std::uint64_t request_id, ByteCounter counter);
  bool has_lane(std::uint32_t stream_id) const { return find(stream_id) != nullptr; }

  /// Takes a block of a frame. Those of streams without a lane, of planes not asked for and of frames
  /// dropped earlier are ignored. A live frame is only begun if it will bring all the planes asked for.
  void push(const BlockPtr& block);

  /// Drops what waits in a lane and closes it; a begun frame is ended by a FrameAbort.
  void close_lane(std::uint32_t stream_id, const std::string& reason);
  void close_all_lanes(const std::string& reason);

  /// The next message to write, or null.
  BlockPtr pop();

  void clear();
  std::size_t queued_bytes() const { return bytes_; }
  std::size_t queued_messages() const;  ///< control messages and blocks
  std::uint64_t frames_dropped() const { return frames_dropped_; }

 private:
  struct QueuedFrame {
    std::uint64_t frame_id = 0;
    std::deque<BlockPtr> blocks;
    bool begun = false;     ///< its FrameBegin has been handed out
    bool complete = false;  ///< its last block is in
    std::uint64_t last_sequence = 0;
  };
  struct Lane {
    std::uint32_t stream_id = 0;
    wire::PlaneSet planes = wire::kAllPlanes;
    bool live = true;
    std::uint64_t request_id = 0;
    ByteCounter counter;
    std::deque<QueuedFrame> frames;
  };

  const Lane* find(std::uint32_t stream_id) const;
  Lane* find(std::uint32_t stream_id);
  void begin_frame(Lane& lane, const BlockPtr& block);
  void enqueue(QueuedFrame& frame, const BlockPtr& block);
  void release(Lane& lane, const Block& block);
  void drop(Lane& lane, std::size_t index);
  void abort(Lane& lane, std::size_t index, const std::string& reason);
  BlockPtr pop_lane(Lane& lane);

  int frames_per_lane_;
  std::size_t live_bytes_;
  std::deque<BlockPtr> control_;
  std::vector<Lane> lanes_;
  std::size_t next_lane_ = 0;
  std::size_t bytes_ = 0;
  std::uint64_t frames_dropped_ = 0;
};

}  // namespace obliq::net
