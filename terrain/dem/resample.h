#pragma once
#include <cstddef>
#include <vector>

#include "terrain/dem/dem_window.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/height_grid.h"

namespace obliq {

// Ground between the last posts of one elevation model and the first of the next.

/// What the files of a mosaic say of nodes around which none of them has all four posts. Files that were cut
/// from one lattice of posts have the four between them: their weights add up to one, and the mean is what
/// interpolation across both would give. Rows may be written by different threads.
class Seams {
 public:
  struct Share {
    int i = 0;           ///< node of the row
    double y_m = 0;      ///< world y that the file's valid posts give
    double weight = 0;   ///< sum of their bilinear weights
    bool owned = false;  ///< one of them stands within half a posting
  };

  explicit Seams(const HeightGrid& grid) : rows_(static_cast<std::size_t>(grid.nz)) {}

  void add(int j, const Share& share) { rows_[static_cast<std::size_t>(j)].push_back(share); }

  /// Gives the nodes that are still unknown, and within half a posting of a post, the mean of their shares.
  void close(HeightGrid& grid);

 private:
  std::vector<std::vector<Share>> rows_;
};

/// Fills voids no wider than widest_m and returns the filled nodes' indices. A void is a set of unknown nodes
/// joined along rows, columns or diagonals; it is as wide as the largest square of unknown nodes in it, so a
/// gap along a river is narrow however long it is. Voids that reach the grid's border are open ground, not
/// gaps: they stay. A filled node is the mean of straight lines drawn across the void along the row, the
/// column and both diagonals, weighted by one over their length: exact on any plane.
std::vector<std::size_t> fill_voids(HeightGrid& grid, double widest_m);

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
