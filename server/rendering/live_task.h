#pragma once
// A live radar's whole frame that the render thread has in hand; see render_live.cpp.
#include <memory>
#include <stop_token>
#include <vector>

#include "server/rendering/begun_frame.h"
#include "server/rendering/render_thread.h"

namespace obliq::net {

/// It has begun, and others may have their turns before it ends.
struct RenderThread::FrameInHand : BegunFrame {
  using BegunFrame::BegunFrame;

  std::vector<AzimuthRange> azimuths;
  std::size_t part = 0;  ///< of the azimuths
  RenderPause pause;     ///< within the part
  Clock::time_point begun;
  std::shared_ptr<const LiveView> view;
  std::uint64_t generation = 0;  ///< of the renderer when it was planned
  std::stop_token stop;
  bool failed = false;
};

}  // namespace obliq::net
