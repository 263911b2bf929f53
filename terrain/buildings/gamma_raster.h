#pragma once
#include "terrain/world.h"

namespace obliq {

/// Gives ground cells what a surface's gamma_raster says of them (World::raster_gamma): its values are
/// decibels, averaged by area as powers where pixels are finer than cells. Where `source` is given, of the
/// cells that hold NaN alone, which it has just painted: those without a value become 1. Without one, of
/// every cell, and cells that get a value get the surface's material too if it has one. A cell has a value
/// where the raster knows at least half of its area. world.raster_gamma must have its size. Throws InputError
/// when the raster cannot be used or read, when a value is beyond +-60 dB, and when values look linear.
void apply_gamma_raster(World& world, const SurfaceSpec& surface);

}  // namespace obliq
