#include "server/apps/serving.h"

#include "server/security/networks.h"
#include "server/security/security.h"

namespace obliq {
namespace {

void check_port(const ServerConfig& server, const std::string& address_key, const std::string& address) {
  security::require_protection(
      address_key, address,
      {{"TLS (server.tls_certificate, server.tls_key)", !server.tls_certificate.empty()},
       {"tokens (server.tokens)", !server.tokens.empty()}},
      "server.unprotected", server.unprotected);
}

}  // namespace

net::ServerOptions serving_options(const SceneConfig& config) {
  net::ServerOptions options;
  static_cast<ServerLimits&>(options) = config.server;
  static_cast<StreamConfig&>(options) = config.stream;
  options.address = config.server.address;
  options.port = static_cast<std::uint16_t>(config.server.port);
  options.dead_after_s = config.server.dead_after_s;
  options.truth_role = config.server.truth_role;
  return options;
}

http::HttpOptions http_options(const SceneConfig& config,
                               std::shared_ptr<const security::Security> security) {
  http::HttpOptions options;
  options.security = std::move(security);
  options.address = config.http.address;
  options.port = static_cast<std::uint16_t>(config.http.port);
  options.max_connections = config.http.max_connections;
  options.max_connections_per_address = config.http.max_connections_per_address;
  options.timeout_s = config.http.timeout_s;
  options.dead_after_s = config.server.dead_after_s;
  options.names = config.http.names;
  options.origins = config.http.origins;
  return options;
}

void check_protection(const SceneConfig& config) {
  check_port(config.server, "server.address", config.server.address);
  if (config.http.enabled) check_port(config.server, "http.address", config.http.address);
}

std::vector<std::string> address_warnings(const SceneConfig& config) {
  const bool reaches_stream = !security::resolves_to_loopback(config.server.address);
  if (!config.http.enabled || !reaches_stream || !security::resolves_to_loopback(config.http.address))
    return {};
  return {"server.address = " + config.server.address +
          " serves other machines, http.address = " + config.http.address +
          " does not: they reach neither the page nor its stream nor /metrics; "
          "http.address = \"" +
          config.server.address +
          "\" opens these too, and http.names takes the name by which browsers call this machine"};
}

std::shared_ptr<security::Security> server_security(const ServerConfig& server) {
  return std::make_shared<security::Security>(
      security::SecurityFiles{server.tokens, server.tls_certificate, server.tls_key});
}

}  // namespace obliq
