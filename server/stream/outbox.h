#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "server/stream/block.h"
#include "server/stream/frame_queue.h"

namespace obliq::net {

/// What waits to be written to one client: control messages, then frames, one lane per stream. Bounded, but
/// for control messages, which are answers: who puts them in counts them. Knows no sockets. For one thread.
class Outbox {
 public:
  Outbox(int frames_per_lane, std::size_t live_bytes)
      : frames_per_lane_(frames_per_lane), live_bytes_(live_bytes) {}
  ~Outbox() { clear(); }
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;

  void push_control(wire::Bytes bytes);
  std::size_t control_size() const { return control_.size(); }

  void open_live_lane(std::uint32_t stream_id, const StreamChoice& choice,
                      LanePolicy policy = LanePolicy::newest_wins);
  /// Vanishes after its only frame.
  void open_once_lane(std::uint32_t stream_id, std::uint64_t request_id, const StreamChoice& choice,
                      ByteCounter counter);
  bool has_lane(std::uint32_t stream_id) const { return lane(stream_id) != nullptr; }
  /// Null when there is none; valid until a lane is opened or closed.
  const FrameLane* lane(std::uint32_t stream_id) const;

  /// Takes a block of a frame; those of streams without a lane are ignored. See FrameLane::push.
  void push(const BlockPtr& block, const LiveFramePtr& frame = nullptr);

  /// Gives up a frame that waits in a lane, with a FrameAbort when it has begun.
  void give_up(std::uint32_t stream_id, std::uint64_t frame_id, const std::string& reason);

  /// Drops what waits in a lane and closes it; a begun frame is ended by a FrameAbort.
  void close_lane(std::uint32_t stream_id, const std::string& reason);
  void close_all_lanes(const std::string& reason);

  /// The next message to write, or null.
  BlockPtr pop();

  void clear();
  std::size_t queued_bytes() const;
  std::uint64_t frames_dropped() const;
  std::size_t queued_messages() const;  ///< control messages and blocks

 private:
  FrameLane* find(std::uint32_t stream_id);

  int frames_per_lane_;
  std::size_t live_bytes_;  ///< of all newest-wins lanes
  std::deque<BlockPtr> control_;
  std::vector<FrameLane> lanes_;
  std::size_t next_lane_ = 0;
  std::uint64_t dropped_by_closed_ = 0;
};

}  // namespace obliq::net
