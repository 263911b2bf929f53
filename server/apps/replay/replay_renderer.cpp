#include "server/apps/replay/replay_renderer.h"

#include <utility>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/radar/receiver/video.h"

namespace obliq {

ReplayRenderer::ReplayRenderer(std::string path, client::RecordingStart start, const ReplayOptions& options,
                               std::function<void(const std::string&)> say, std::function<void()> ended)
    : player_(std::make_unique<ReplayPlayer>(std::move(path), std::move(start), options, std::move(say),
                                             std::move(ended))) {}

std::string ReplayRenderer::fixed() const {
  return "this server replays a recording of radar " + player_->start().radar +
         ": it can be watched, not controlled, and renders nothing else";
}

wire::PlaneSet ReplayRenderer::planes() const {
  const wire::PlaneSet recorded = player_->start().planes;
  const wire::RadarSettings& message = player_->start().descriptor->settings();
  RadarSettings settings;
  // Servers before the video plane name no span.
  const bool has_video = merge_message(message, settings).empty() && message.video_span_db() > 0;
  const bool follows =
      (recorded & wire::plane_bit(wire::Plane::iq)) != 0 && has_video && video_needs_iq(settings);
  return follows ? static_cast<wire::PlaneSet>(recorded | wire::plane_bit(wire::Plane::video)) : recorded;
}

std::vector<FieldError> ReplayRenderer::place(const PoseSettings&) const {
  return {{"pose", "a pose", "none: " + fixed()}};
}

}  // namespace obliq
