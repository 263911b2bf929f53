#pragma once
#include <span>

#include "server/control/scene_keys.h"

namespace obliq {

/// Scalar keys of [flight]: how the daemon moves its loaded terrain with radars that fly.
std::span<const Row<SceneConfig>> flight_entries();

}  // namespace obliq
