#include "server/rendering/job.h"

#include <utility>

#include "terrain/base/errors.h"

namespace obliq::rendering {

bool RenderContext::gives_way() const {
  const bool changed = changes != changes_seen;
  if (!changed && turn_ends == Job::Time::max()) return false;
  const auto time = now();
  return time >= turn_ends || (changed && time >= turn_began + kShortestTurn);
}

bool RenderContext::turn(ParkedWork& work, std::chrono::milliseconds least, std::int64_t most_work) const {
  return work.turn([&](std::int64_t done) {
    if (done >= most_work) return true;
    return gives_way() && (least.count() == 0 || now() >= turn_began + least);
  });
}

RenderOptions RenderContext::render_options(bool iq, bool states, std::stop_token stop) const {
  RenderOptions render;
  render.threads = options.threads;
  render.iq = iq;
  render.states = states;
  render.stop = std::move(stop);
  return render;
}

std::int64_t in_nanoseconds(Job::Time time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

std::vector<FieldError> memory_failure(const std::exception& failure) {
  return {{"frame", failure_text(failure), "a frame that can be rendered with the memory there is"}};
}

}  // namespace obliq::rendering
