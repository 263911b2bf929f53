#pragma once
#include "terrain/world.h"

namespace obliq {

/// Gives the surface's material to every ground cell whose centre lies in a pixel of one of its classes.
/// world.surface_material must have its size. Throws InputError when the raster cannot be used or read.
void paint_classes(World& world, const SurfaceSpec& surface);

}  // namespace obliq
