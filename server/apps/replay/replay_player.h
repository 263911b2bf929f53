#pragma once
// What of a recording is shown when: reads it, keeps its clock, and goes where clients want to go.
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "client/recording/recorded_frames.h"
#include "client/recording/recording_search.h"
#include "server/apps/replay/playback_clock.h"
#include "server/apps/replay/recorded_time.h"
#include "server/rendering/frame_renderer.h"
#include "server/rendering/replay_control.h"

namespace obliq {

struct ReplayOptions {
  double speed = 1;  ///< infinity: as fast as clients ask
  bool loop = false;
  bool hold = false;            ///< at its end it stands still instead of being over
  bool keep_bookmarks = false;  ///< those that are set are written into the recording
  /// Where places count from; nothing: from the first frame. Of radars that are shown in step.
  std::optional<std::int64_t> origin_utc_ns{};
};

/// Slower than a hundredth or faster than a million times, a replay shows nothing.
constexpr double kSlowestReplay = 0.01;
constexpr double kFastestReplay = 1e6;
/// What is said to be allowed, before the word for infinity.
std::string replay_speeds();

class ReplayPlayer : public rendering::ReplayControl {
 public:
  /// say: gets what is missing in the recording. ended: called once, after the last frame, unless it loops
  /// or holds. Throws InputError.
  ReplayPlayer(std::string path, client::RecordingStart start, const ReplayOptions& options,
               std::function<void(const std::string&)> say, std::function<void()> ended);

  /// Of another radar of the recording: from now on both are at one place, and steering one steers both.
  /// Before either plays; both must outlive all use.
  void keep_in_step(ReplayPlayer& other);

  const client::RecordingStart& start() const { return start_; }
  bool has_passes() const { return search_->first().is_pass; }
  /// What is missing in the recording, as far as it has been read.
  client::RecordingLosses losses() const;

  /// The next frame, when it is due; nothing new: waits a while. For one thread at a time.
  rendering::FrameRenderer::Plan plan(const SettingsPtr& settings);

  /// Hands out no more; a current frame ends at once where it may wait for long.
  void stop();

  std::vector<FieldError> set(const wire::SetReplay& request) override;
  void write_state(wire::ReplayState& state) const override;
  void each_event(const std::function<void(const wire::ExerciseEvent&)>& call) const override;
  void keep(const wire::ExerciseEvent& bookmark) override;
  void watched(bool by_anyone, bool newcomer) override;
  void on_change(std::function<void()> call) override;

 private:
  struct Due {
    std::shared_ptr<client::RecordedFrame> frame;
    std::int64_t at_ns = 0;  ///< by the clock
  };
  /// A place that is to be shown.
  struct Seek {
    std::int64_t at_ns = 0;  ///< from the recording's start
    std::optional<std::int64_t> sim_time_ns{};
  };

  // With `reading_` held:
  std::optional<Due> read_frame();
  void go_to(const Seek& place);
  bool is_kept(const Due& due) const { return due.at_ns <= keep_until_ns_; }
  Due take_newest();
  void end();

  // With `state_` held:
  void seek_to(const Seek& place);
  std::int64_t place_ns() const;

  /// What a client of another radar has set.
  void follow(wire::SetReplay request);
  void take(const wire::SetReplay& request);
  void update_watched();

  bool is_over() const;
  void tell() const;
  std::int64_t from_start_ns(std::int64_t utc_ns) const;

  const std::string path_;
  const client::RecordingStart start_;
  const ReplayOptions options_;
  const std::function<void(const std::string&)> say_;
  const std::function<void()> ended_;
  PlaybackClock clock_;
  bool has_sim_times_ = false;                       ///< its poses, at either end
  std::unique_ptr<client::RecordingSearch> search_;  ///< plan()'s, but for what never changes
  std::int64_t origin_utc_ns_ = 0;
  std::int64_t duration_ns_ = 0;
  std::vector<ReplayPlayer*> in_step_;  ///< others
  std::atomic<bool> has_watchers_ = false;

  mutable std::mutex reading_;  ///< guards what follows, up to the next comment of this kind
  std::unique_ptr<client::RecordedFrames> frames_;
  RecordedTime time_;
  std::optional<Due> next_;
  std::int64_t keep_until_ns_ = -1;  ///< frames up to that time are shown, however late: it went there
  std::uint64_t jumps_ = 0;  ///< the clock's, when it went there; with another number, a place is sought
  client::RecordingLosses losses_;

  mutable std::mutex state_;  ///< guards what follows; held for moments only
  std::optional<Seek> seek_;
  bool over_ = false;
  std::uint64_t seeks_ = 0;
  std::int64_t frame_at_ns_ = 0;     ///< of the newest frame, by the clock
  std::int64_t frame_place_ns_ = 0;  ///< and from the recording's start
  std::optional<std::int64_t> frame_sim_time_ns_;
  std::function<void()> changed_;
};

}  // namespace obliq
