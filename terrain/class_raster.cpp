#include "terrain/class_raster.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cmath>

#include "terrain/errors.h"
#include "terrain/gdal_messages.h"
#include "terrain/geodetic_lattice.h"
#include "terrain/parallel.h"
#include "terrain/resample.h"

namespace obliq {
namespace {

constexpr double kMostPixels = 0x1p30;

/// One byte a pixel of a window: 1 where the pixel is of a wanted class.
struct ClassWindow {
  PixelRect rect;
  std::vector<std::uint8_t> wanted;

  bool at(double column, double row) const {
    const double c = std::floor(column + 0.5) - rect.column0;
    const double r = std::floor(row + 0.5) - rect.row0;
    if (!(c >= 0 && r >= 0 && c < rect.columns() && r < rect.rows())) return false;
    return wanted[static_cast<std::size_t>(r) * static_cast<std::size_t>(rect.columns()) +
                  static_cast<std::size_t>(c)] != 0;
  }
};

ClassWindow read_classes(const Raster& raster, const PixelRect& rect, const std::vector<int>& classes) {
  if (static_cast<double>(rect.columns()) * rect.rows() > kMostPixels) {
    raster.refuse("the loaded area has more than 2^30 of its pixels", "a coarser raster or a smaller area");
  }
  ClassWindow window;
  window.rect = rect;
  window.wanted.reserve(static_cast<std::size_t>(rect.columns()) * static_cast<std::size_t>(rect.rows()));
  std::vector<double> line(static_cast<std::size_t>(rect.columns()));
  GdalMessages messages;
  for (int r = rect.row0; r < rect.row1; ++r) {
    const CPLErr error = raster.band().RasterIO(GF_Read, rect.column0, r, rect.columns(), 1, line.data(),
                                                rect.columns(), 1, GDT_Float64, 0, 0, nullptr);
    if (error != CE_None || !messages.failure().empty()) {
      raster.refuse("row " + std::to_string(r) + " cannot be read: " + messages.reason("the file is damaged"),
                    "a whole, readable raster");
    }
    for (double value : line) {
      window.wanted.push_back(std::any_of(classes.begin(), classes.end(),
                                          [&](int wanted) { return value == static_cast<double>(wanted); }));
    }
  }
  return window;
}

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

void paint_row(World& world, int j, const PostLattice& lattice, const ClassWindow& window,
               double shift_columns, std::uint8_t material) {
  const HeightGrid& grid = world.grid;
  const LatticeRow row(lattice, grid.node_z_m(j) + grid.cell_m / 2);
  std::uint8_t* materials =
      world.surface_material.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.nx - 1);
  for (int i = 0; i < grid.nx - 1; ++i) {
    const LatticePoint p = row.at(grid.node_x_m(i) + grid.cell_m / 2);
    const double height_m =
        GeodeticLattice::kHigh_m * (centre_y_m(grid, i, j) - p.y_m[0]) / (p.y_m[1] - p.y_m[0]);
    const double share = layer_share(height_m);
    const double column = p.column[0] + share * (p.column[1] - p.column[0]) + shift_columns;
    if (window.at(column, p.row[0] + share * (p.row[1] - p.row[0]))) materials[i] = material;
  }
}

}  // namespace

void paint_classes(World& world, const SurfaceSpec& surface) {
  const HeightGrid& grid = world.grid;
  const Raster raster(surface.source, "[[surfaces]] source", {});
  const GeodeticLattice geodetic =
      geodetic_lattice(world.frame, {grid.x0_m, grid.z0_m, grid.x1_m(), grid.z1_m()});
  const PostLattice lattice = post_lattice(geodetic, raster);
  const double turn = raster.turn_columns();
  for (double turns : {0.0, -1.0, 1.0}) {
    if (turns != 0 && turn == 0) continue;
    const PixelRect rect = needed_pixels(lattice, grid, raster, 1, turns * turn);
    if (rect.empty()) continue;
    const ClassWindow window = read_classes(raster, rect, surface.classes);
    for_each_row(grid.nz - 1,
                 [&](int j) { paint_row(world, j, lattice, window, turns * turn, surface.material); });
  }
}

}  // namespace obliq
