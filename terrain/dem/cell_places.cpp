#include "terrain/dem/cell_places.h"

namespace obliq {
namespace {

/// Heights of a cell's corners stand for its centre's; unknown ones count as 0, where nothing is seen anyway.
double centre_y_m(const HeightGrid& grid, int i, int j) {
  double sum = 0;
  for (int dj : {0, 1}) {
    for (int di : {0, 1}) {
      if (grid.node_known(i + di, j + dj)) sum += grid.node_y_m(i + di, j + dj) / 4;
    }
  }
  return sum;
}

}  // namespace

void for_each_cell_place(const HeightGrid& grid, int j, const PostLattice& lattice,
                         const std::function<void(int i, double column, double row)>& at) {
  const LatticeRow row(lattice, grid.node_z_m(j) + grid.cell_m / 2);
  for (int i = 0; i < grid.nx - 1; ++i) {
    const LatticePoint p = row.at(grid.node_x_m(i) + grid.cell_m / 2);
    const double height_m =
        GeodeticLattice::kHigh_m * (centre_y_m(grid, i, j) - p.y_m[0]) / (p.y_m[1] - p.y_m[0]);
    const double share = layer_share(height_m);
    at(i, p.column[0] + share * (p.column[1] - p.column[0]), p.row[0] + share * (p.row[1] - p.row[0]));
  }
}

}  // namespace obliq
