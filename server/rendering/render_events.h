#pragma once
// What the render thread is asked to render once, and what it reports.
#include <atomic>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "server/control/mount.h"
#include "server/flight/pose_time_line.h"
#include "server/radar/settings.h"
#include "server/radar/targets/target.h"
#include "server/rendering/rendered.h"
#include "server/stream/frame_queue.h"
#include "server/stream/live_frames.h"
#include "server/stream/stream_choice.h"
#include "terrain/base/errors.h"

namespace obliq::rendering {

/// How a live radar looks, from the next frame on. Never changes once made.
struct LiveView {
  SettingsPtr settings;
  PoseSettings pose;
  std::int64_t pose_received_ns = 0;
  std::shared_ptr<const PoseTimeLine> poses;  ///< null: the pose above stays
  bool pose_stale = false;
  Mount mount{};
  TargetMoment targets_at{};  ///< when targets are shown with it

  /// The antenna looks no further than its gimbal lets it.
  void hold() { pose = held_by(mount, settings->settings, pose); }
  /// The same with the pose of a moment of the server's monotonic clock, held.
  LiveView at(std::int64_t now_ns) const {
    LiveView view = *this;
    if (!poses) return view;  // held when it was made
    const PoseAt at = poses->at(now_ns);
    view.pose = at.pose;
    view.pose_received_ns = at.received_ns;
    view.pose_stale = at.stale;
    view.targets_at = {at.shown_ns, at.timed};
    view.hold();
    return view;
  }
};

/// One RenderOnce request.
struct FrameRequest {
  std::uint64_t client_id = 0;
  std::uint64_t request_id = 0;
  std::uint32_t stream_id = 0;
  std::string radar;  ///< echoed
  LiveView view;
  stream::StreamChoice choice;
  FrameCost cost;
  TargetsPtr targets;     ///< in its world; null: none
  std::stop_source stop;  ///< requested when its client has gone
  stream::ByteCounter queued =
      std::make_shared<std::atomic<std::size_t>>(0);  ///< bytes its client has not taken
};
using FrameRequestPtr = std::shared_ptr<FrameRequest>;

/// Settings whose faults the ground decides: whether a frame of them can be planned from a pose.
struct Appraisal {
  std::uint64_t client_id = 0;
  RadarSettings settings;
  std::uint64_t version = 0;  ///< of the radar's settings that they are a change of
  PoseSettings pose;
  std::stop_source stop;  ///< requested when its client has gone
};
using AppraisalPtr = std::shared_ptr<Appraisal>;

/// Called on the render thread or on the rendering's own threads, one call at a time.
class RenderEvents {
 public:
  virtual ~RenderEvents() = default;
  virtual void on_live_blocks(std::size_t radar, const stream::LiveFramePtr& frame,
                              std::vector<stream::BlockPtr> blocks) = 0;
  virtual void on_live_rendered(std::size_t radar, const RenderedFrame& frame) = 0;
  /// A frame is due, but live_frames is at its limit. Repeated until one has gone.
  virtual void on_live_held_up(std::size_t radar, double since_s) = 0;
  /// The radar cannot be rendered as it is; it is tried again when its view changes.
  virtual void on_live_fault(std::size_t radar, const std::shared_ptr<const LiveView>& view,
                             const std::vector<FieldError>& errors) = 0;
  virtual void on_request_block(const FrameRequestPtr& request, const stream::BlockPtr& block) = 0;
  virtual void on_request_rendered(const RenderedRequest& frame) = 0;
  /// Instead of a frame.
  virtual void on_request_fault(const FrameRequestPtr& request, const std::vector<FieldError>& errors) = 0;
  /// No faults: a frame can be planned, as far as beam and pulse go.
  virtual void on_appraised(const AppraisalPtr& appraisal, const std::vector<FieldError>& faults) = 0;
  /// After finish(): nothing more comes.
  virtual void on_finished() = 0;
};

}  // namespace obliq::rendering
