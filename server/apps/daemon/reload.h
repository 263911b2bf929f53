#pragma once
#include <string>
#include <vector>

#include "server/control/scene_config.h"

namespace obliq {

/// "main, nose"
std::string radar_names(const SceneConfig& config);

/// Keys whose values differ and that only a restart applies: addresses, ports, files of certificate and
/// tokens, which radars there are, threads. What is not named here a running daemon takes over: the radars'
/// parameters, terrain, buildings, materials, earth, accuracy, flight, the log, the limits of [server].
std::vector<std::string> keys_for_restart(const SceneConfig& running, const SceneConfig& wanted);

/// Everything that a scene is built from, as text: keys, and sizes and times of the files that are local. Two
/// that are equal build the same scene.
std::string scene_signature(const SceneConfig& config);

}  // namespace obliq
