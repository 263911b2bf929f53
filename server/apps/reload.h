#pragma once
#include <string>
#include <vector>

#include "server/control/scene_config.h"

namespace obliq {

/// Keys whose values differ and that only a restart applies: addresses, ports, files of certificate and
/// tokens, the radars, threads. What is not named here a running daemon takes over: terrain, buildings,
/// materials, earth, accuracy, flight, the log, the limits of [server].
std::vector<std::string> keys_for_restart(const SceneConfig& running, const SceneConfig& wanted);

/// Whether the two differ in what a scene is built from.
bool needs_new_scene(const SceneConfig& running, const SceneConfig& wanted);

}  // namespace obliq
