#pragma once
#include <span>

#include "server/control/scene_keys.h"

namespace obliq {

/// Scalar keys of [server]: where the daemon listens and what it lets a peer ask of it.
std::span<const Row<SceneConfig>> server_entries();

}  // namespace obliq
