#pragma once
#include <memory>
#include <utility>

#include "server/rendering/frame_renderer.h"
#include "server/rendering/rendered.h"
#include "server/stream/frame_encoder.h"
#include "server/stream/live_frames.h"

namespace obliq::net {

/// A frame of the stream that has begun: what whole frames and passes of a scan have in common.
struct BegunFrame {
  BegunFrame(FrameIdentity identity, std::uint64_t& sequence, const RadarSettings& settings)
      : frame_id(identity.frame_id), encoder(std::move(identity), sequence), stats(settings) {}

  const std::uint64_t frame_id;
  LiveFramePtr frame;
  FrameEncoder encoder;
  FrameSum stats;
  RenderedFrame rendered;
  bool states = false;
  std::unique_ptr<PlannedFrame> plan;
};

}  // namespace obliq::net
