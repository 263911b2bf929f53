#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "proto/limits.h"
#include "server/flight/keeper_state.h"
#include "server/net/statistics.h"

namespace obliq::net {

class Security;

/// What the network side of a server may be told. Times in seconds.
struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = wire::kDefaultPort;  ///< 0: any free one
  std::string server_name = "obliqd";
  std::string server_version;
  std::string scene_name;

  std::shared_ptr<Security> security;  ///< null: no TLS, no tokens, everybody is admin

  int max_clients = 64;
  int max_clients_per_address = 32;  ///< of IPv6, a /64 network
  std::uint32_t max_request_bytes = wire::kMaxRequestBytes;
  int max_renders_queued = 4;  ///< unfinished RenderOnce requests of one client
  int max_subscriptions = 16;  ///< of one client
  double max_rate_hz = 100;
  std::int64_t max_bins = 8192LL * 8192LL;      ///< of one frame
  std::int64_t max_pixels = 16384LL * 16384LL;  ///< of one frame
  /// Pixels and bins of all clients' unfinished RenderOnce requests: here three of the largest frames.
  std::int64_t max_work_queued = 1'000'000'000;
  std::int64_t max_memory_mb = 0;  ///< of this process with what a request needs; 0: no limit
  int queue_frames = 2;            ///< per subscription: the begun one and those that wait
  /// Bytes of live frames that wait for one client; a begun frame that would exceed them is aborted.
  std::size_t queue_bytes = std::size_t{256} << 20;
  /// A RenderOnce frame is rendered in slices of about this many bytes, the next one when the client has
  /// taken this much: however large the frame, no more of it is held than twice this.
  std::size_t slice_bytes = std::size_t{16} << 20;

  int live_frames = 3;  ///< of a radar: a further one waits until all clients have done with one
  /// When a radar has waited for so long, newest-wins clients that hold its oldest frame up have it aborted.
  double abort_after_s = 1;
  double lossless_limit_s = 10;  ///< a lossless client that holds its radar up and takes nothing is dropped

  double handshake_timeout_s = 10;  ///< from connection to Hello
  double message_timeout_s = 10;    ///< from the first byte of a message to its last
  double heartbeat_s = 10;          ///< the longest silence of the server, and of a client before it is asked
  double idle_timeout_s = 0;        ///< a client that says nothing for so long is closed; 0: never
  double dead_after_s = 60;         ///< see watch_for_dead_peer
  double stall_timeout_s = 30;      ///< a client that takes no byte for so long is dropped
  double stop_limit_s = 5;          ///< for begun frames and queues when stopping; then they are cut
  double stop_grace_s = 0.5;        ///< for the last words to each client when stopping

  int render_threads = 0;                 ///< 0: all cores
  std::function<void(int)> before_wedge;  ///< test hook, see RenderOptions
  /// Hears where all radars are, the first one first, whenever one has moved or looks further. On the io
  /// thread; must be quick.
  std::function<void(std::vector<RadarPlace>)> on_moved;
  /// What there is to say about scenes loaded while serving; for Status.
  std::function<KeeperState()> keeper_state;
  /// Hears of each live frame rendered to its end: the radar's name, and what it took. On the io thread.
  std::function<void(const std::string&, const RenderedFrame&)> on_frame;
  std::function<void(const RenderedOnce&)> on_once_frame;  ///< the same of RenderOnce frames
};

}  // namespace obliq::net
