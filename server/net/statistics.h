#pragma once
// What the network side counts, for status and metrics.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace obliq::net {

struct RadarStatistics {
  std::string name;
  std::size_t watchers = 0;
  double rate_hz = 0;   ///< the fastest watcher's
  double coverage = 0;  ///< of the newest frame
  bool controlled = false;
  bool faulty = false;            ///< cannot be rendered as it is
  int live_frames = 0;            ///< being rendered, or waiting in whole or in part for a client
  std::size_t live_bytes = 0;     ///< of their blocks
  std::uint64_t frames_shed = 0;  ///< whole ones, never begun, for want of time
};

struct RoomStatistics {
  std::size_t clients = 0;
  std::size_t renders_queued = 0;  ///< unfinished RenderOnce requests
  std::uint64_t bytes_sent = 0;
  std::uint64_t frames_dropped = 0;
  std::size_t queued_messages = 0;  ///< in all outboxes
  std::size_t queued_bytes = 0;
  std::vector<RadarStatistics> radars;
};

}  // namespace obliq::net
