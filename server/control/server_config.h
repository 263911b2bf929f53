#pragma once
#include <cstdint>
#include <string>

namespace obliq {

/// Where the daemon listens and what it lets a peer ask of it.
struct ServerConfig {
  std::string address = "127.0.0.1";
  int port = 7420;  ///< 0: any free one
  int max_clients = 64;
  int max_request_bytes = 1 << 20;
  double handshake_timeout_s = 10;
  std::int64_t max_bins = 8192LL * 8192LL;  ///< in one frame
  int queue_frames = 2;                     ///< frames that wait for a slow client; the newest wins
};

}  // namespace obliq
