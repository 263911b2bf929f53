#include "tests/integration/web_server.h"

#include <utility>

#include "server/http/answering.h"
#include "server/websocket/upgrade.h"

namespace obliq::test {

http::HttpOptions web_options() {
  http::HttpOptions options;
  options.max_connections = options.max_connections_per_address = 1000;
  options.timeout_s = 5;
  return options;
}

net::ServerOptions patient_options() {
  net::ServerOptions options = small_options();
  options.handshake_timeout_s = options.message_timeout_s = 20;
  return options;
}

WebServer::WebServer(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
                     net::ServerOptions options, http::HttpOptions http)
    : server_(io_.context(), renderer, radars, options, net::ReservedPort("127.0.0.1", 0)),
      http_(
          io_.context(),
          [&] {
            http.security = options.security;
            return std::move(http);
          }(),
          {},
          websocket::upgrade(
              io_.context(), [this] { return &server_; }, [] { return http::error_page(503, "loading"); })) {
  server_.start([this] {
    http_.stop();
    io_.release();
  });
}

WebServer::~WebServer() {
  server_.stop();
  io_.join();
}

}  // namespace obliq::test
