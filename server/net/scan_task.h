#pragma once
// What the render thread keeps of a radar whose antenna scans; see render_scan.cpp.
#include <memory>
#include <optional>
#include <vector>

#include "server/net/frame_encoder.h"
#include "server/net/frame_renderer.h"
#include "server/net/live_frames.h"
#include "server/net/render_thread.h"
#include "server/net/scan_schedule.h"

namespace obliq::net {

/// A pass that has begun: one frame of the stream.
struct ScanPass {
  ScanPass(FrameIdentity identity, std::uint64_t& sequence, const RadarSettings& settings)
      : frame_id(identity.frame_id), encoder(std::move(identity), sequence), stats(settings) {}

  const std::uint64_t frame_id;
  LiveFramePtr frame;
  FrameEncoder encoder;
  FrameSum stats;
  RenderedFrame rendered;
  bool states = false;
  std::vector<bool> wanted;  ///< [wedges] that somebody asked for
  std::unique_ptr<PlannedFrame> plan;
  PoseSettings planned_pose;
  std::vector<AzimuthRange> missed;
};

struct RenderThread::ScanTask {
  ScanTask(SettingsPtr of, Clock::time_point begin)
      : settings(std::move(of)), schedule(settings->settings, begin) {}

  SettingsPtr settings;
  ScanSchedule schedule;
  Dwell next;  ///< in order
  std::unique_ptr<ScanPass> pass;
};

}  // namespace obliq::net
