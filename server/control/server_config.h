#pragma once
#include <cstdint>
#include <string>

namespace obliq {

/// Where the daemon listens and what it lets a peer ask of it.
struct ServerConfig {
  std::string address = "127.0.0.1";
  int port = 7420;              ///< 0: any free one
  std::string tokens;           ///< path; empty: no tokens
  std::string tls_certificate;  ///< path; empty: no TLS
  std::string tls_key;          ///< path
  bool unprotected = false;     ///< serves other machines without TLS or tokens
  int max_clients = 64;
  int max_clients_per_address = 32;
  int max_request_bytes = 1 << 20;
  double handshake_timeout_s = 10;
  double message_timeout_s = 10;
  double stall_timeout_s = 30;
  double heartbeat_s = 10;
  double idle_timeout_s = 0;  ///< 0: never
  double dead_after_s = 60;
  std::int64_t max_bins = 8192LL * 8192LL;      ///< in one frame
  std::int64_t max_pixels = 16384LL * 16384LL;  ///< in one frame
  std::int64_t max_work_queued = 1'000'000'000;
  std::int64_t max_memory_mb = 0;  ///< 0: no limit
  int max_radars = 16;
  int max_renders_queued = 4;
  int max_subscriptions = 16;
  double stop_limit_s = 5;  ///< for begun frames and queues when stopping
  int queue_frames = 2;     ///< frames that wait for a slow client; the newest wins
};

}  // namespace obliq
