#pragma once
// What a request is answered: the page of its route, or why not.
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_server.h"

namespace boost::system {
class error_code;
}

namespace obliq::http {

/// What this server is called.
struct Site {
  bool tls = false;
  std::vector<std::string> names;    ///< of hosts, besides addresses and localhost
  std::vector<std::string> origins;  ///< "https://screens.example", besides its own
};

/// Whether Host (with or without a port) is an address, localhost or a name of the site.
bool is_own_host(std::string_view host, const Site& site);
/// Whether an Origin is that of a page which this server sent under that Host, or one of the site's.
bool is_own_origin(std::string_view origin, std::string_view host, const Site& site);

/// How far the daemon is, for /readyz. From any thread.
class Readiness {
 public:
  enum class Phase { loading, ready, stopping };
  struct State {
    Phase phase = Phase::loading;
    std::string stage = "starting";  ///< of loading
    double fraction = 0;             ///< of the stage
  };

  /// Without effect once stopping.
  void loading(const std::string& stage, double fraction) { set({Phase::loading, stage, fraction}); }
  void ready() { set({Phase::ready, "", 1}); }
  void stopping() { set({Phase::stopping, "", 0}); }
  State state() const {
    const std::lock_guard lock(mutex_);
    return state_;
  }

 private:
  void set(State state) {
    const std::lock_guard lock(mutex_);
    if (state_.phase != Phase::stopping) state_ = std::move(state);
  }
  mutable std::mutex mutex_;
  State state_;
};

/// Of a request, what its answer depends on.
struct Asked {
  std::string peer;  ///< "127.0.0.1:50000"
  std::string_view target;
  std::string_view authorization;  ///< the field of that name, as those below
  std::string_view host;
  std::string_view origin;     ///< empty: none was sent
  bool has_origins = false;    ///< more than one
  std::string_view protocols;  ///< Sec-WebSocket-Protocol
  std::string_view key;        ///< Sec-WebSocket-Key, where there is one
  bool is_read = false;        ///< GET or HEAD
  bool has_body = false;
  bool is_upgrade = false;  ///< to a WebSocket
};

/// Why a request is refused whatever its path: Host or Origin are not this server's (403, and a log line), or
/// there is no Host, or more than one of either (400).
std::optional<Page> foreign_page(const Asked& asked, const Site& site);

/// `security` null: every client may read.
Page page_of(const Asked& asked, const std::vector<Route>& routes, const security::Security* security);

/// Of "/metrics?x=1" and of the absolute form "http://host/metrics", which servers must accept (RFC 9112
/// section 3.2.2): "/metrics".
std::string_view path_of(std::string_view target);

/// What answers a header that cannot be read; none when the client is gone.
std::optional<Page> header_refusal(const boost::system::error_code& error);

/// Why a request for the path of `upgrade` is refused, if it is.
std::optional<Page> upgrade_refusal(const Asked& asked, const Upgrade& upgrade);

Page error_page(int status, const std::string& text);

/// A page as it is sent, with the fields that all answers have. To HEAD without the body.
std::string response_text(const Page& page, bool head, bool keep_alive, unsigned http_version);

/// 200 as long as the process answers at all, also while it loads.
Page health_page();

/// 200 when the terrain is committed and the TCP port listens; else 503 with what it waits for.
Page readiness_page(const Readiness::State& state);

/// Prometheus' text format, version 0.0.4.
Page metrics_page(std::string text);

}  // namespace obliq::http
