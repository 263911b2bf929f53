#pragma once
// What the render thread keeps of a radar whose antenna scans; see render_scan.cpp.
#include <memory>
#include <optional>
#include <vector>

#include "server/rendering/begun_frame.h"
#include "server/rendering/render_thread.h"
#include "server/rendering/scan_schedule.h"

namespace obliq::net {

/// A pass that has begun: one frame of the stream.
struct ScanPass : BegunFrame {
  using BegunFrame::BegunFrame;

  std::vector<bool> wanted;  ///< [wedges] that somebody asked for
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
