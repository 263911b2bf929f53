#pragma once
// The pages that tell an operator, a container engine or a load balancer how the daemon is.
#include <string>

#include "server/http/http_server.h"
#include "server/http/readiness.h"

namespace obliq::http {

/// 200 as long as the process answers at all, also while it loads.
Page health_page();

/// 200 when the terrain is committed and the TCP port listens; else 503 with what it waits for.
Page readiness_page(const Readiness::State& state);

/// Prometheus' text format, version 0.0.4.
Page metrics_page(std::string text);

}  // namespace obliq::http
