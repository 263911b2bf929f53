#pragma once
#include "terrain/dem/dem_window.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/dem/seams.h"
#include "terrain/height_grid.h"

namespace obliq {

/// The pixels of a raster that the grid's nodes can need, whatever the heights (-500 to 9,000 m), columns
/// shifted by shift_columns; empty when they miss the raster.
PixelRect needed_pixels(const PostLattice& lattice, const HeightGrid& grid, const Raster& raster, int step,
                        double shift_columns);

/// Gives every unknown node the height of the DEM at its place: solves for the height h whose geodetic
/// position, at world (x, z), is where the DEM says h. Nodes off the window or over voids stay unknown;
/// of those that have some valid posts around them, seams (when given) learns what these say.
void fill_from_window(HeightGrid& grid, const PostLattice& lattice, const DemWindow& window,
                      double shift_columns, Seams* seams);

}  // namespace obliq
