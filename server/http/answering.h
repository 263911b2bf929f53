#pragma once
// What a request is answered: the page of its route, or why not.
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_server.h"
#include "server/http/readiness.h"

namespace obliq::http {

/// Of a request, what its answer depends on.
struct Asked {
  std::string peer;  ///< "127.0.0.1:50000"
  std::string_view target;
  std::string_view authorization;  ///< the field of that name
  bool is_read = false;            ///< GET or HEAD
  bool has_body = false;
};

/// `security` null: every client may read.
Page page_of(const Asked& asked, const std::vector<Route>& routes, const net::Security* security);

Page error_page(int status, const std::string& text);

/// 200 as long as the process answers at all, also while it loads.
Page health_page();

/// 200 when the terrain is committed and the TCP port listens; else 503 with what it waits for.
Page readiness_page(const Readiness::State& state);

/// Prometheus' text format, version 0.0.4.
Page metrics_page(std::string text);

}  // namespace obliq::http
