#pragma once
// What the render thread keeps of a RenderOnce request; see render_once.cpp.
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/rendering/frame_renderer.h"
#include "server/rendering/render_thread.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

struct RenderThread::OnceTask {
  /// Counts the block as waiting before anyone can take it.
  void send(RenderEvents& events, const BlockPtr& block) const {
    *job->queued += block->bytes.size();
    events.on_once_block(job, block);
  }

  OnceJobPtr job;
  std::unique_ptr<PlannedFrame> frame;
  std::optional<FrameEncoder> encoder;
  std::uint64_t sequence = 0;
  std::optional<FrameSum> stats;
  int next_azimuth = 0;  ///< of the slice in hand
  int end_azimuth = 0;   ///< of the window
  RenderPause pause;     ///< within the slice
  double render_s = 0;
};

/// Says that a frame could not be rendered for want of memory, or of another of the machine's means.
std::vector<FieldError> memory_failure(const std::exception& failure);
/// Why in words for clients: std::bad_alloc has none of its own.
std::string words_of(const std::exception& failure);

}  // namespace obliq::net
