#pragma once
// A recording in the place of a radar, so that the server's own network side replays it.
#include <functional>
#include <memory>
#include <string>

#include "server/apps/replay/replay_player.h"
#include "server/rendering/frame_renderer.h"

namespace obliq {

/// Hands out the recorded frames of one radar at their times, each wedge when it was sent. Time begins with
/// the first client that watches and stands still while none does; a frame that was not asked for in time is
/// left out when the next one is due, as by a radar. Clients pause it, change its speed and its place; what
/// one of them does holds for all.
class ReplayRenderer : public rendering::FrameRenderer {
 public:
  /// As ReplayPlayer.
  ReplayRenderer(std::string path, client::RecordingStart start, const ReplayOptions& options,
                 std::function<void(const std::string&)> say, std::function<void()> ended);

  std::vector<FieldError> place(const PoseSettings& pose) const override;
  Plan plan(const SettingsPtr& settings, const PoseSettings&) const override {
    return player_->plan(settings);
  }
  std::string fixed() const override;
  /// Those that were recorded, and video where it follows from I&Q.
  wire::PlaneSet planes() const override;
  bool has_passes() const override { return player_->has_passes(); }
  rendering::ReplayControl* replay() const override { return player_.get(); }

  /// Of another radar of the same recording.
  void keep_in_step(ReplayRenderer& other) { player_->keep_in_step(*other.player_); }

  void stop() { player_->stop(); }
  client::RecordingLosses losses() const { return player_->losses(); }

 private:
  std::unique_ptr<ReplayPlayer> player_;
};

}  // namespace obliq
