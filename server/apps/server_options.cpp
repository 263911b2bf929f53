#include "server/apps/server_options.h"

#include "server/net/exposure.h"
#include "server/net/security.h"

namespace obliq {

net::ServerOptions server_options(const SceneConfig& config) {
  net::ServerOptions options;
  options.address = config.server.address;
  options.port = static_cast<std::uint16_t>(config.server.port);
  options.server_version = OBLIQ_VERSION;
  options.scene_name = config.name;
  options.max_clients = config.server.max_clients;
  options.max_clients_per_address = config.server.max_clients_per_address;
  options.max_request_bytes = static_cast<std::uint32_t>(config.server.max_request_bytes);
  options.handshake_timeout_s = config.server.handshake_timeout_s;
  options.message_timeout_s = config.server.message_timeout_s;
  options.stall_timeout_s = config.server.stall_timeout_s;
  options.heartbeat_s = config.server.heartbeat_s;
  options.idle_timeout_s = config.server.idle_timeout_s;
  options.dead_after_s = config.server.dead_after_s;
  options.max_bins = config.server.max_bins;
  options.max_pixels = config.server.max_pixels;
  options.max_work_queued = config.server.max_work_queued;
  options.max_memory_mb = config.server.max_memory_mb;
  options.max_renders_queued = config.server.max_renders_queued;
  options.max_subscriptions = config.server.max_subscriptions;
  options.queue_frames = config.server.queue_frames;
  options.stop_limit_s = config.server.stop_limit_s;
  options.live_frames = config.stream.live_frames;
  options.abort_after_s = config.stream.abort_after_s;
  options.lossless_limit_s = config.stream.lossless_limit_s;
  options.render_threads = config.threads;
  return options;
}

void check_server_protection(const ServerConfig& server, const std::string& address_key,
                             const std::string& address) {
  net::require_protection(address_key, address,
                          {{"TLS (server.tls_certificate, server.tls_key)", !server.tls_certificate.empty()},
                           {"tokens (server.tokens)", !server.tokens.empty()}},
                          "server.unprotected", server.unprotected);
}

std::shared_ptr<net::Security> server_security(const ServerConfig& server) {
  return std::make_shared<net::Security>(
      net::SecurityFiles{server.tokens, server.tls_certificate, server.tls_key});
}

}  // namespace obliq
