#pragma once
#include "server/control/scene_config.h"
#include "server/http/metrics.h"
#include "server/net/options.h"

namespace obliq {

/// What a scene file says about serving, for the network side.
net::ServerOptions server_options(const SceneConfig& config);

/// This program's version and compiler, and the versions of the libraries that decide its results.
http::BuildInfo build_info();

}  // namespace obliq
