#pragma once
// What rendering a frame costs, before and after.
#include <cstdint>

namespace obliq::rendering {

/// What a frame takes, known before it is rendered (server/net/requests/request_limits.h).
struct FrameCost {
  std::int64_t pixels = 0;
  std::int64_t bins = 0;
  std::int64_t samples = 0;    ///< of trains of pulses
  std::int64_t plan_taps = 0;  ///< of the beam's plan
  std::int64_t bytes = 0;      ///< an estimate

  /// What max_work_queued counts.
  std::int64_t work() const { return pixels + bins; }
};

/// A completed frame of a RenderOnce request.
struct RenderedRequest {
  double render_s = 0;  ///< of all its slices, without the waits between them
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
};

/// A completed live frame.
struct RenderedFrame {
  double waited_s = 0;       ///< from the date when it was due to its planning
  double render_s = 0;       ///< from its planning to its last block, with the turns of others in between
  double first_wedge_s = 0;  ///< from its planning to its first wedge
  /// From the arrival of its pose to its last block; negative for all but the first frame of each pose.
  double pose_to_end_s = -1;
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
  double coverage = 0;              ///< fraction of the sector that known ground covers
  std::uint64_t dwells_missed = 0;  ///< of a pass of a scanning antenna
};

}  // namespace obliq::rendering
