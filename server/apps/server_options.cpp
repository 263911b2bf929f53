#include "server/apps/server_options.h"

namespace obliq {

net::ServerOptions server_options(const SceneConfig& config) {
  net::ServerOptions options;
  options.address = config.server.address;
  options.port = static_cast<std::uint16_t>(config.server.port);
  options.server_version = OBLIQ_VERSION;
  options.scene_name = config.name;
  options.max_clients = config.server.max_clients;
  options.max_request_bytes = static_cast<std::uint32_t>(config.server.max_request_bytes);
  options.handshake_timeout_s = config.server.handshake_timeout_s;
  options.max_bins = config.server.max_bins;
  options.queue_frames = config.server.queue_frames;
  options.render_threads = config.threads;
  options.stop_on_signals = true;
  return options;
}

}  // namespace obliq
