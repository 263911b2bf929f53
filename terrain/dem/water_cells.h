#pragma once
#include <cstdint>
#include <vector>

#include "terrain/dem/dem_window.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Which cells of a grid are water (terrain/dem/water.h), found out while the grid is filled file by file:
/// each cell by the file that completes its four nodes.
class WaterCells {
 public:
  explicit WaterCells(const HeightGrid& grid);

  /// After a file's window has filled the grid.
  void decide(const HeightGrid& grid, const PostLattice& lattice, const DemWindow& window, double posting_m,
              double shift_columns);

  /// Once all files have filled the grid, and the seams between them: cells on a seam go with those beside
  /// them.
  void settle(const HeightGrid& grid);

  /// A bit a cell, [nz - 1][nx - 1]; none when no cell is water.
  std::vector<std::uint8_t> bits() const;

 private:
  enum State : std::uint8_t { undecided, land, water };
  std::vector<std::uint8_t> states_;
};

/// Gives the cells of these bits the material, but for those without known ground, and returns their area.
/// `materials` gets its size where it has none.
double paint_water(const HeightGrid& grid, const std::vector<std::uint8_t>& bits, std::uint8_t material,
                   std::vector<std::uint8_t>& materials);

}  // namespace obliq
