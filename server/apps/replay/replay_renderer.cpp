#include "server/apps/replay/replay_renderer.h"

#include <utility>

namespace obliq {

ReplayRenderer::ReplayRenderer(std::string path, client::RecordingStart start, const ReplayOptions& options,
                               std::function<void(const std::string&)> say, std::function<void()> ended)
    : player_(std::make_unique<ReplayPlayer>(std::move(path), std::move(start), options, std::move(say),
                                             std::move(ended))) {}

std::string ReplayRenderer::fixed() const {
  return "this server replays a recording of radar " + player_->start().radar +
         ": it can be watched, not controlled, and renders nothing else";
}

std::vector<FieldError> ReplayRenderer::place(const PoseSettings&) const {
  return {{"pose", "a pose", "none: " + fixed()}};
}

}  // namespace obliq
