#pragma once
#include <cstdint>
#include <vector>

#include "terrain/dem/dem_window.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Which cells of a grid are water (terrain/dem/water_cells.h), found out while the grid is filled file by
/// file: each cell by the file that completes its four nodes.
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

/// Regions of exactly equal height are water from this area on: lidar models are "hydro-flattened" so, from 2
/// acres on (USGS Lidar Base Specification, 0.8 ha); this is larger, since plains may be level, too.
constexpr double kLeastLevel_m2 = 1e6;

/// The sea begins at posts of these heights above the datum: models have it at 0, tides and the geoid's error
/// take it a little below.
constexpr double kSeaLowest_m = -1;
constexpr double kSeaHighest_m = 0;
/// It reaches over neighbours that differ by no more, and lie below this.
constexpr double kSeaStep_m = 0.25;
constexpr double kSeaShore_m = 1;
/// It is at least so large, or runs out of the elevation model.
constexpr double kLeastSea_m2 = 10e6;

/// 1 where a post of the window is water: [nz][nx]. posting_m: between the raster's own posts. Level ground
/// is looked for in models with fractions of a unit alone: in whole metres every plain is level. Neither is a
/// terrace water, from which the ground around steps up or down by whole metres: such models were made from
/// whole metres, or contours, and moved to another datum.
std::vector<std::uint8_t> water_posts(const DemWindow& window, double posting_m);

}  // namespace obliq
