#pragma once
#include <string>

#include "server/control/scene_config.h"

namespace obliq {

/// The whole configuration as a scene file, every key with its unit, its limits and what a change takes.
/// Loads again to the same configuration, from any folder.
std::string print_config(const SceneConfig& config);

}  // namespace obliq
