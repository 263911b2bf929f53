#pragma once
#include "terrain/world.h"

namespace obliq {

/// Gives ground cells their materials from [[surfaces]], in order, later ones over earlier ones. A cell has
/// the material of what lies at its centre. Leaves surface_material empty when there are none. Throws
/// InputError.
void paint_surfaces(World& world, const WorldSpec& spec, const Progress& progress);

}  // namespace obliq
