#pragma once
#include <span>

#include "server/control/scene_keys.h"

namespace obliq {

/// Scalar keys of [http] and [log]: what an operator sees of the running daemon.
std::span<const Row<SceneConfig>> operation_entries();

}  // namespace obliq
