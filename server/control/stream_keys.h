#pragma once
#include <span>

#include "server/control/scene_keys.h"

namespace obliq {

/// The keys of [stream].
std::span<const Row<SceneConfig>> stream_entries();

}  // namespace obliq
