#pragma once
#include <utility>

#include "server/http/http_server.h"
#include "server/net/io_thread.h"
#include "tests/integration/net_fixture.h"
#include "tests/integration/web_peer.h"

namespace obliq::test {

http::HttpOptions web_options();

/// A stream's server whose clients may also come through HTTP.
class WebServer {
 public:
  WebServer(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
            net::ServerOptions options, http::HttpOptions http = web_options());
  ~WebServer();

  client::Endpoint web() const { return {"127.0.0.1", http_.port()}; }
  client::Endpoint tcp() const { return {"127.0.0.1", server_.port()}; }
  net::Server& server() { return server_; }

 private:
  net::IoThread io_;
  net::Server server_;
  http::HttpServer http_;
};

/// Time enough for Hello and for messages on the slowest machine.
net::ServerOptions patient_options();

/// A WebServer with the radars "main" and "nose".
struct WebPattern {
  explicit WebPattern(net::ServerOptions options = patient_options(), http::HttpOptions http = web_options())
      : server(renderer, {small_radar("main"), small_radar("nose")}, options, std::move(http)) {}
  PatternRenderer renderer;
  WebServer server;
};

}  // namespace obliq::test
