#pragma once
// A recording in the place of a radar, so that the server's own network side replays it.
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/recorded_frames.h"
#include "server/rendering/frame_renderer.h"

namespace obliq {

/// When things of a recording are due. The times in it are those of the server's clock, which may have been
/// set while it recorded: time never runs backwards here, and no pause is longer than kLongestPause.
class ReplayClock {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kLongestPause{300};

  /// speed: recorded seconds in a second; infinity: everything is due at once.
  explicit ReplayClock(double speed) : speed_(speed) {}

  /// For times in the order of the recording. The first one is due now.
  Clock::time_point due(std::int64_t utc_ns);

  /// The recording begins again: its first time is due as long after the last as that was after the one
  /// before it, or a second where there was none.
  void begin_again();

  /// The next time is due now: no client watched, and time stood still.
  void stand_still() { newest_ns_.reset(); }

  /// How long a recorded time takes here.
  Clock::duration scaled(std::int64_t recorded_ns) const;

 private:
  double speed_;
  std::optional<std::int64_t> newest_ns_;
  std::int64_t last_gap_ns_ = 1'000'000'000;
  Clock::time_point due_;
};

struct ReplayOptions {
  double speed = 1;  ///< infinity: as fast as clients ask
  bool loop = false;
};

/// Hands out the recorded frames of one radar at their times, each wedge when it was sent. Time begins with
/// the first frame asked for and stands still while no client asks; a frame that was not asked for in time is
/// left out when the next one is due, as by a radar.
class ReplayRenderer : public net::FrameRenderer {
 public:
  /// say: hears what is missing in the recording. ended: called once, after the last frame, unless it loops.
  ReplayRenderer(std::string path, client::RecordingStart start, const ReplayOptions& options,
                 std::function<void(const std::string&)> say, std::function<void()> ended);

  std::vector<FieldError> place(const PoseSettings& pose) const override;
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override;
  std::string fixed() const override;
  wire::PlaneSet planes() const override { return start_.planes; }

  /// What is missing in the recording, as far as it has been read.
  client::RecordingLosses losses() const;

 private:
  struct Due {
    std::shared_ptr<client::RecordedFrame> frame;
    ReplayClock::Clock::time_point at;
  };
  std::optional<Due> read_frame() const;

  const std::string path_;
  const client::RecordingStart start_;
  const ReplayOptions options_;
  const std::function<void(const std::string&)> say_;
  const std::function<void()> ended_;

  mutable std::mutex mutex_;  ///< guards everything below
  mutable std::unique_ptr<client::RecordedFrames> frames_;
  mutable ReplayClock clock_;
  mutable std::optional<Due> next_;
  mutable bool over_ = false;
  mutable client::RecordingLosses losses_;
};

}  // namespace obliq
