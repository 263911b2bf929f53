#pragma once
#include <spdlog/spdlog.h>

#include <thread>
#include <vector>

#include "server/net/server.h"

namespace obliq::bench {

/// A server in a thread of this program, on any free port of the loopback, for as long as this lives. It says
/// warnings alone.
class Served {
 public:
  Served(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
         net::ServerOptions options)
      : server_(renderer, radars, with_free_port(std::move(options))), thread_([this] { server_.run(); }) {
    spdlog::set_level(spdlog::level::warn);
  }
  ~Served() {
    server_.stop();
    thread_.join();
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  std::uint16_t port() const { return server_.port(); }

 private:
  static net::ServerOptions with_free_port(net::ServerOptions options) {
    options.port = 0;
    return options;
  }

  net::Server server_;
  std::thread thread_;
};

}  // namespace obliq::bench
