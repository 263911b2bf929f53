#pragma once
#include "terrain/world.h"

namespace obliq {

/// Fills world.grid and its part of world.report from [terrain]; world.frame must be set. Throws InputError.
void load_ground(World& world, const WorldSpec& spec, const Progress& progress);

}  // namespace obliq
