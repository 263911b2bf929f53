#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "proto/limits.h"
#include "server/control/sections/server.h"
#include "server/control/sections/target_config.h"
#include "server/flight/window.h"
#include "server/ground_query/ground_query.h"
#include "server/rendering/rendered.h"
#include "server/security/token_file.h"

namespace obliq::security {
class Security;
}

namespace obliq::net {

/// Of a subscription: a frame in a quarter of an hour. Much lower rates would overflow the clock.
inline constexpr double kLeastRate_hz = 0.001;

/// What the network side of a server may be told. Times in seconds.
struct ServerOptions : ServerLimits, StreamConfig {
  std::string address = "127.0.0.1";
  std::uint16_t port = wire::kDefaultPort;  ///< 0: any free one
  std::string server_name = "obliqd";
  std::string server_version;
  std::string scene_name;

  std::shared_ptr<security::Security> security;      ///< null: no TLS, no tokens, every client is admin
  TruthRole truth_role = ServerConfig{}.truth_role;  ///< needed for the places of targets

  std::uint32_t max_hello_bytes = wire::kMaxHelloBytes;  ///< of any message before Hello is answered
  std::uint32_t max_descriptor_bytes = wire::kMaxDescriptorBytes;  ///< of a request's protobuf part

  double max_rate_hz = 100;  ///< of a subscription
  /// Bytes of live frames that wait for one client; a begun frame that would exceed them is aborted.
  std::size_t queue_bytes = std::size_t{256} << 20;
  /// A RenderOnce frame is rendered in slices of about this many bytes, the next one when the client has
  /// taken this much: however large the frame, no more of it is held than twice this.
  std::size_t slice_bytes = std::size_t{16} << 20;

  double dead_after_s = ServerConfig{}.dead_after_s;  ///< see watch_for_dead_peer
  double stop_grace_s = 0.5;                          ///< for the last message to each client when stopping

  int render_threads = 0;                ///< 0: all cores
  std::vector<TargetType> target_types;  ///< of the scene
  std::vector<TargetConfig> targets;     ///< of the world, at first
  std::int64_t target_seed = 1;          ///< of their fluctuation
  int materials = 255;                   ///< of the scene, at most
  /// Told where all radars are, in their order, whenever one has moved or looks further. On the io thread;
  /// must be quick.
  std::function<void(std::vector<RadarPlace>)> on_moved;
  /// Whether an antenna at a pose has ground to look at, within r_max_m. Must be quick.
  std::function<GroundThere(const PoseSettings&, double)> ground_at;
  /// Answers a checked question about the ground. On a thread of its own; empty: the server has no ground.
  std::function<GroundAnswers(const GroundQuestion&, const std::stop_token&)> query_ground;
  /// State of the loading of scenes while serving; for Status.
  std::function<KeeperState()> keeper_state;
  /// Told of each live frame rendered to its end: the radar's name, and what it took. On the io thread.
  std::function<void(const std::string&, const rendering::RenderedFrame&)> on_frame;
  std::function<void(const rendering::RenderedRequest&)> on_request_frame;  ///< the same of RenderOnce frames
};

/// Who may have the places of targets.
inline security::Role truth_role(const ServerOptions& options) {
  return static_cast<security::Role>(options.truth_role);
}

// What the network side counts, for status and metrics.

struct RadarStatistics {
  std::string name;
  std::size_t watchers = 0;
  double rate_hz = 0;   ///< the fastest watcher's
  double coverage = 0;  ///< of the newest frame
  bool controlled = false;
  bool faulty = false;            ///< cannot be rendered as it is
  int live_frames = 0;            ///< being rendered, or waiting in whole or in part for a client
  std::size_t live_bytes = 0;     ///< of their blocks
  std::size_t spare_bytes = 0;    ///< of blocks that were sent, kept for the next
  std::uint64_t frames_shed = 0;  ///< whole ones, never begun, for lack of time
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
