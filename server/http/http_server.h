#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>  // Boost 1.74's coroutines use std::exchange without including it
#include <vector>

namespace boost::asio {
class io_context;
}

namespace obliq::security {
class Security;
}

namespace obliq::net {
class SocketTransport;
}  // namespace obliq::net

namespace obliq::http {

/// What a path answers.
struct Page {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  int retry_after_s = 0;  ///< said to the client, unless it is 0
};

struct Route {
  std::string path;
  bool is_open = false;        ///< needs no token
  std::function<Page()> page;  ///< called for each GET or HEAD on the io thread; must be quick
};

/// A path where a connection stops being HTTP and becomes a WebSocket (RFC 6455 section 4.2).
struct Upgrade {
  std::string path;
  std::string protocol;                           ///< the subprotocol that a client must name
  std::function<std::optional<Page>()> obstacle;  ///< the answer when it may not be now
  /// Takes the connection on the io thread: it has not been answered. `header`: of the request, as text;
  /// `unread`: what has come behind it.
  std::function<void(std::unique_ptr<net::SocketTransport> transport, std::string header, std::string unread)>
      take;
};

struct HttpOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any free one
  int max_connections = 64;
  int max_connections_per_address = 16;  ///< of IPv6, a /64 network
  std::vector<std::string> names;        ///< see Site; `address` is one as well
  std::vector<std::string> origins;      ///< see Site
  std::uint32_t max_header_bytes = 8192;
  int max_requests = 1000;                             ///< on one connection
  std::shared_ptr<const security::Security> security;  ///< certificate and tokens; null: none
  double dead_after_s = 60;                            ///< see net::watch_for_dead_peer
  double timeout_s = 10;  ///< for a header to arrive, for an answer to be taken, between two requests
};

/// Answers GET and HEAD for a few paths, through TLS where there is a certificate, and those that are not
/// open only with a token (`Authorization: Bearer TOKEN`) where there are tokens. Requests with a
/// body, other methods, long or slow headers, other Hosts and Origins (site.h) are refused; of too many
/// connections, in all or from one address, the oldest that asks nothing goes, or else the newest is refused.
/// All on the thread of `io`, but the constructor and the arithmetic of TLS handshakes.
class HttpServer {
 public:
  /// Listens at once. Throws InputError that names http.address or http.port.
  HttpServer(boost::asio::io_context& io, HttpOptions options, std::vector<Route> routes,
             std::optional<Upgrade> upgrade = std::nullopt);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  std::uint16_t port() const;
  const std::string& address() const;  ///< "127.0.0.1:7480"
  /// "http://127.0.0.1:7480/": where a browser on this machine finds the page.
  std::string url() const;
  /// Listens no more and closes all connections. From any thread; any number of times.
  void stop();

 private:
  struct State;
  std::shared_ptr<State> state_;  ///< connections hold it as well
};

}  // namespace obliq::http
