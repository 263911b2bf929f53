#pragma once
#include "server/control/scene_config.h"
#include "server/net/options.h"

namespace obliq {

/// What a scene file says about serving, for the network side.
net::ServerOptions server_options(const SceneConfig& config);

}  // namespace obliq
