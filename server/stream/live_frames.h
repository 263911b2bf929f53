#pragma once
// How many frames of a radar are alive: being rendered, or waiting in whole or in part for some client.
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "server/stream/block.h"

namespace obliq::stream {

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

}  // namespace obliq::stream
