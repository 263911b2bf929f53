#include "server/apps/daemon/server_options.h"

#include "server/apps/version/version.h"
#include "server/scene/embree_tracer.h"
#include "server/security/networks.h"
#include "server/security/security.h"
#include "terrain/dem/gdal_messages.h"

namespace obliq {

net::ServerOptions server_options(const SceneConfig& config) {
  net::ServerOptions options;
  static_cast<ServerLimits&>(options) = config.server;
  static_cast<StreamConfig&>(options) = config.stream;
  options.address = config.server.address;
  options.port = static_cast<std::uint16_t>(config.server.port);
  options.server_version = program_version();
  options.scene_name = config.name;
  options.dead_after_s = config.server.dead_after_s;
  options.render_threads = config.threads;
  options.materials = static_cast<int>(config.materials.size());
  return options;
}

void check_server_protection(const ServerConfig& server, const std::string& address_key,
                             const std::string& address) {
  net::require_protection(address_key, address,
                          {{"TLS (server.tls_certificate, server.tls_key)", !server.tls_certificate.empty()},
                           {"tokens (server.tokens)", !server.tokens.empty()}},
                          "server.unprotected", server.unprotected);
}

std::vector<std::string> address_warnings(const SceneConfig& config) {
  const bool reaches_stream = !net::resolves_to_loopback(config.server.address);
  if (!config.http.enabled || !reaches_stream || !net::resolves_to_loopback(config.http.address)) return {};
  return {"server.address = " + config.server.address +
          " serves other machines, http.address = " + config.http.address +
          " does not: they reach neither the page nor its stream nor /metrics; "
          "http.address = \"" +
          config.server.address +
          "\" opens these too, and http.names takes the name by which browsers call this machine"};
}

std::shared_ptr<net::Security> server_security(const ServerConfig& server) {
  return std::make_shared<net::Security>(
      net::SecurityFiles{server.tokens, server.tls_certificate, server.tls_key});
}

http::BuildInfo build_info() {
  http::BuildInfo build;
  build.version = program_version();
#if defined(__clang__)
  build.compiler = "clang " __clang_version__;
#else
  build.compiler = "GCC " __VERSION__;
#endif
  build.embree = EmbreeTracer::version();
  build.gdal = gdal_version();
  return build;
}

}  // namespace obliq
