#pragma once
#include <string>
#include <vector>

#include "server/control/scene_config.h"
#include "server/http/metrics.h"
#include "server/net/options.h"

namespace obliq {

/// What a scene file says about serving, for the network side.
net::ServerOptions server_options(const SceneConfig& config);

/// A port that other machines can reach needs TLS and tokens, or server.unprotected. For every port that goes
/// by the tokens: the stream's and HTTP's, each with the key of its address. Throws InputError.
void check_server_protection(const ServerConfig& server, const std::string& address_key,
                             const std::string& address);

/// What of the addresses is not wrong but may not be meant, in sentences.
std::vector<std::string> address_warnings(const SceneConfig& config);

/// Certificate, key and tokens, for all ports to share. Throws InputError that names file and reason.
std::shared_ptr<net::Security> server_security(const ServerConfig& server);

/// This program's version and compiler, and the versions of the libraries that decide its results.
http::BuildInfo build_info();

}  // namespace obliq
