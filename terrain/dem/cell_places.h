#pragma once
#include <functional>

#include "terrain/dem/geodetic_lattice.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Calls at(i, column, row) for the cells of one row of the grid: where the ground over the cell's centre
/// lies in a raster's post coordinates.
void for_each_cell_place(const HeightGrid& grid, int j, const PostLattice& lattice,
                         const std::function<void(int i, double column, double row)>& at);

}  // namespace obliq
