#pragma once
#include <string>
#include <vector>

#include "server/control/scene_config.h"

namespace obliq {

/// Keys whose values differ and that only a restart applies: addresses, ports, files of certificate and
/// tokens, the radars, threads. What is not named here a running daemon takes over: terrain, buildings,
/// materials, earth, accuracy, flight, the log, the limits of [server].
std::vector<std::string> keys_for_restart(const SceneConfig& running, const SceneConfig& wanted);

/// Everything that a scene is built from, as text: keys, and sizes and times of the files that are local. Two
/// that are equal build the same scene.
std::string scene_signature(const SceneConfig& config);

}  // namespace obliq
