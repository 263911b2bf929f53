#pragma once
// [server], [http], [stream] and [flight]: where the daemon listens, what a peer may ask, how its ground
// moves.
#include <cstdint>
#include <string>
#include <vector>

namespace obliq {

struct Section;

/// Of tokens: those of server/security, in their order.
enum class TruthRole { viewer, controller, admin };

/// What a peer may ask of the daemon. All of it is reloaded at SIGHUP. Times in seconds.
struct ServerLimits {
  int max_clients = 64;
  int max_clients_per_address = 32;  ///< of IPv6, a /64 network
  int max_waiting = 32;              ///< connections that have not said Hello; the clients above have
  int max_request_bytes = 1 << 20;
  double handshake_timeout_s = 10;  ///< from connection to Hello
  double message_timeout_s = 10;    ///< from the first byte of a message to its last
  double stall_timeout_s = 30;      ///< a client that takes no byte for this long is dropped
  double heartbeat_s = 10;          ///< the longest silence of the server, and of a client before it is asked
  double idle_timeout_s = 0;        ///< a client that sends nothing for this long is closed; 0: never
  std::int64_t max_bins = 8192LL * 8192LL;      ///< in one frame
  std::int64_t max_pixels = 16384LL * 16384LL;  ///< in one frame
  /// Pixels and bins of all clients' unfinished RenderOnce requests: here three of the largest frames.
  std::int64_t max_work_queued = 1'000'000'000;
  /// Weights of a beam's plan. So many take 160 MB, as much again in each thread, and two seconds of work.
  std::int64_t max_plan_taps = 20'000'000;
  /// Of this process with what a request needs. 0: three quarters of the memory there is (memory_limit_mb).
  double max_memory_mb = 0;
  int max_renders_queued = 4;  ///< unfinished RenderOnce requests of one client
  int max_subscriptions = 16;  ///< of one client
  int max_targets = 10000;     ///< in the world, and in one RenderOnce
  double stop_limit_s = 5;     ///< for begun frames and queues when stopping; then they are cut
  int queue_frames = 2;        ///< per subscription: the begun one and those that wait; the newest wins
};

/// Where the daemon listens, and its limits.
struct ServerConfig : ServerLimits {
  std::string address = "127.0.0.1";
  int port = 7420;              ///< 0: any free one
  std::string tokens;           ///< path; empty: no tokens
  std::string tls_certificate;  ///< path; empty: no TLS
  std::string tls_key;          ///< path
  bool unprotected = false;     ///< serves other machines without TLS or tokens
  double dead_after_s = 60;
  int max_radars = 16;
  TruthRole truth_role = TruthRole::controller;  ///< who may have the places of targets
};

extern const Section kServerSection;

/// [http]: where the daemon answers /healthz, /readyz and /metrics, and serves the page.
struct HttpConfig {
  bool enabled = true;
  std::string address = "127.0.0.1";
  int port = 7480;  ///< 0: any free one
  int max_connections = 64;
  int max_connections_per_address = 16;
  std::vector<std::string> names;    ///< a Host may be, besides addresses and localhost
  std::vector<std::string> origins;  ///< an Origin may be, besides the server's own
  double timeout_s = 10;  ///< for a request's header to arrive, for an answer to be taken, between requests
  std::vector<double> range_scales{10, 20, 40, 80};  ///< of the page's buttons, in range_unit
  std::string range_unit = "NM";
};

extern const Section kHttpSection;

/// [stream]: what a radar does for clients that cannot keep up with it.
struct StreamConfig {
  int live_frames = 3;  ///< of a radar: a further one waits until all clients have done with one
  /// When a radar has waited for so long, newest-wins clients that hold its oldest frame up have it aborted.
  double abort_after_s = 1;
  double lossless_limit_s = 10;  ///< a lossless client that holds its radar up and takes nothing is dropped
};

extern const Section kStreamSection;

/// [flight]: how the daemon moves its loaded terrain with radars that fly.
struct FlightConfig {
  bool enabled = true;
  double reorigin_km = 20;  ///< the origin moves to the first radar when it is further than this from it
  double max_reach_km = 0;  ///< what is loaded around a radar is never for more range; 0: its r_max at start
  double max_megaposts = 64;  ///< a larger window is not loaded while serving
};

extern const Section kFlightSection;
extern const Section kLogSection;

}  // namespace obliq
