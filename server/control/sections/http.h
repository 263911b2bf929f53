#pragma once
// [http]: where the daemon answers /healthz, /readyz and /metrics.
#include <string>

namespace obliq {

struct Section;

/// Where the daemon answers /healthz, /readyz and /metrics.
struct HttpConfig {
  bool enabled = true;
  std::string address = "127.0.0.1";
  int port = 7480;  ///< 0: any free one
  int max_connections = 64;
  int max_connections_per_address = 16;
  double timeout_s = 10;  ///< for a request's header to arrive, for an answer to be taken, between requests
};

extern const Section kHttpSection;

}  // namespace obliq
