#include "server/net/live_radar.h"

#include <algorithm>
#include <map>
#include <string>

#include "server/stream/frame_encoder.h"
#include "terrain/base/units.h"

namespace obliq::net {
namespace {

/// One frame that waits for clients.
struct HeldFrame {
  std::vector<Watcher*> holders;
  bool begun = false;     ///< by one of them
  bool lossless = false;  ///< for one of them
};

/// Between an offence and its consequence: if this process itself stood still (stopped, swapped out), clients
/// that do read have taken the frame by then.
constexpr double kLastChance_s = 0.5;

/// By frame number: the oldest first.
std::map<std::uint64_t, HeldFrame> held_frames(LiveRadar& radar) {
  std::map<std::uint64_t, HeldFrame> frames;
  for (Watcher& watcher : radar.watchers) {
    const stream::FrameQueue* queue = watcher.peer->outbox.queue(radar.stream_id);
    if (queue == nullptr) continue;
    for (std::size_t i = 0; i < queue->held(); ++i) {
      const stream::FrameQueue::Held held = queue->held(i);
      HeldFrame& frame = frames[held.frame_id];
      frame.holders.push_back(&watcher);
      frame.begun |= held.begun;
      frame.lossless |= queue->policy() == stream::QueuePolicy::lossless;
    }
  }
  return frames;
}

void give_up(const LiveRadar& radar, std::uint64_t frame_id, const HeldFrame& frame) {
  for (Watcher* watcher : frame.holders) {
    watcher->peer->outbox.give_up(radar.stream_id, frame_id, "the client reads too slowly");
    watcher->peer->kick();
  }
}

/// Why a client that holds the oldest frame must be closed; empty: it may stay.
std::string offence(const stream::FrameQueue& queue, std::uint64_t oldest, const ServerOptions& options) {
  if (queue.policy() == stream::QueuePolicy::lossless &&
      seconds_since(queue.last_progress()) > options.lossless_limit_s)
    return "the client reads too slowly: lossless, and nothing taken for stream.lossless_limit_s";
  for (std::size_t i = 0; i < queue.held(); ++i) {
    const stream::FrameQueue::Held held = queue.held(i);
    if (held.frame_id == oldest && queue.policy() == stream::QueuePolicy::newest_wins &&
        seconds_since(held.since) > options.stall_timeout_s)
      return "the client reads too slowly: it has held up the radar's oldest frame for longer than "
             "server.stall_timeout_s";
  }
  return {};
}

}  // namespace

rendering::LiveView LiveRadar::shown() const { return view().at(stream::monotonic_ns()); }

void relieve(LiveRadar& radar, const ServerOptions& options, double held_up_s) {
  const auto frames = held_frames(radar);
  if (frames.empty()) return;  // the last block is just being written
  const auto waiting = std::find_if(frames.begin(), frames.end(), [](const auto& entry) {
    return !entry.second.begun && !entry.second.lossless;
  });
  if (waiting != frames.end()) return give_up(radar, waiting->first, waiting->second);
  if (held_up_s > options.abort_after_s) {
    const auto oldest =
        std::find_if(frames.begin(), frames.end(), [](const auto& entry) { return !entry.second.lossless; });
    if (oldest != frames.end()) return give_up(radar, oldest->first, oldest->second);
  }
  const auto& [oldest, frame] = *frames.begin();
  for (Watcher* watcher : frame.holders) {
    const stream::FrameQueue* queue = watcher->peer->outbox.queue(radar.stream_id);
    const std::string reason = queue == nullptr ? "" : offence(*queue, oldest, options);
    if (reason.empty()) continue;
    if (watcher->accused_frame != oldest) {
      watcher->accused_frame = oldest;
      watcher->accused = stream::FrameQueue::Clock::now();
    }
    if (seconds_since(watcher->accused) > kLastChance_s)
      watcher->peer->fail(wire::ErrorNumber::reads_too_slowly, reason);
  }
}

}  // namespace obliq::net
