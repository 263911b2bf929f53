#pragma once
#include "terrain/world.h"

namespace obliq {

/// Gives ground cells their materials from [[surfaces]], in order, later ones over earlier ones. A cell has
/// the material of what lies at its centre. Leaves surface_material empty when there are none, raster_gamma
/// when none has a gamma raster. What is painted has no raster's values but its own. Throws InputError.
void paint_surfaces(World& world, const WorldSpec& spec, const Progress& progress);

/// Gives the surface's material to every ground cell whose centre lies in a pixel of one of its classes.
/// world.surface_material must have its size. Throws InputError when the raster cannot be used or read.
void paint_classes(World& world, const SurfaceSpec& surface);

}  // namespace obliq
