#pragma once
// How many frames of a radar are alive: being rendered, or waiting in whole or in part for some client.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "proto/message_codec.h"
#include "proto/plane.h"
#include "server/stream/stream_choice.h"

namespace obliq::net {

/// Memory that a radar's blocks take, wherever they wait. From any thread.
struct BlockMeter {
  std::atomic<std::size_t> blocks{0};
  std::atomic<std::size_t> bytes{0};
};

class LiveFrames;

/// A frame on its way to clients. Alive as long as it is referenced; never changes.
class LiveFrame {
 public:
  LiveFrame(std::shared_ptr<LiveFrames> owner, std::uint64_t frame_id, std::vector<std::uint64_t> takers);
  ~LiveFrame();
  LiveFrame(const LiveFrame&) = delete;
  LiveFrame& operator=(const LiveFrame&) = delete;

  /// Whether the frame was rendered for this subscription.
  bool is_for(std::uint64_t watch_id) const;
  const std::uint64_t id;

 private:
  std::shared_ptr<LiveFrames> owner_;
  std::vector<std::uint64_t> takers_;  ///< rising
};
using LiveFramePtr = std::shared_ptr<const LiveFrame>;

/// Counts the frames of one radar. From any thread.
class LiveFrames : public std::enable_shared_from_this<LiveFrames> {
 public:
  /// on_freed: called whenever a frame has gone, on the thread that released it last.
  explicit LiveFrames(std::function<void()> on_freed) : on_freed_(std::move(on_freed)) {}

  LiveFramePtr open(std::uint64_t frame_id, std::vector<std::uint64_t> takers);
  int live() const { return live_; }
  const std::shared_ptr<BlockMeter>& meter() const { return meter_; }
  /// on_freed is not called any more once this returns.
  void forget_listener();

 private:
  friend class LiveFrame;
  void freed();

  std::atomic<int> live_{0};
  std::shared_ptr<BlockMeter> meter_ = std::make_shared<BlockMeter>();
  std::mutex mutex_;  ///< guards on_freed_
  std::function<void()> on_freed_;
};

/// An encoded message of a frame, shared by all clients it goes to. Never changes once made.
struct Block {
  Block() = default;
  ~Block() {
    if (!meter) return;
    --meter->blocks;
    meter->bytes -= bytes.size();
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  wire::Bytes bytes;
  wire::MessageType type{};
  wire::PlaneSet planes = 0;  ///< wedge_block: its plane; frame_begin: the planes that will follow
  BlockFormat format;         ///< wedge_block: as of its plane; frame_begin: its window alone counts
  std::uint32_t stream_id = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t sequence = 0;
  std::shared_ptr<BlockMeter> meter;  ///< counts it; may be null
};
using BlockPtr = std::shared_ptr<const Block>;

}  // namespace obliq::net
