#pragma once
// What every program that serves clients does with [server], [stream] and [http]: obliqd, obliq replay.
#include <memory>
#include <string>
#include <vector>

#include "server/control/scene_config.h"
#include "server/http/http_server.h"
#include "server/net/options.h"

namespace obliq {

/// What [server] and [stream] say, for the network side.
net::ServerOptions serving_options(const SceneConfig& config);

/// What [http] says.
http::HttpOptions http_options(const SceneConfig& config, std::shared_ptr<const security::Security> security);

/// A port that other machines can reach needs TLS and tokens, or server.unprotected: the stream's, and HTTP's
/// where it is enabled; both go by the tokens. Throws InputError.
void check_protection(const SceneConfig& config);

/// What of the addresses is not wrong but may not be meant, in sentences.
std::vector<std::string> address_warnings(const SceneConfig& config);

/// Certificate, key and tokens, for all ports to share. Throws InputError that names file and reason.
std::shared_ptr<security::Security> server_security(const ServerConfig& server);

}  // namespace obliq
