#pragma once
#include <cstddef>
#include <vector>

#include "terrain/height_grid.h"

namespace obliq {

/// Fills voids no wider than widest_m and returns the filled nodes' indices. A void is a set of unknown nodes
/// joined along rows, columns or diagonals; it is as wide as the largest square of unknown nodes in it, so a
/// gap along a river is narrow however long it is. Voids that reach the grid's border are open ground, not
/// gaps: they stay. A filled node is the mean of straight lines drawn across the void along the row, the
/// column and both diagonals, weighted by one over their length: exact on any plane.
std::vector<std::size_t> fill_voids(HeightGrid& grid, double widest_m);

}  // namespace obliq
