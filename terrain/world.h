#pragma once
#include <cstdint>
#include <vector>

#include "terrain/base/parallel.h"
#include "terrain/buildings/buildings.h"
#include "terrain/dem/load_report.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/world_spec.h"

namespace obliq {

/// Everything static that a radar can see. Immutable once loaded; shared by all threads.
struct World {
  WorldFrame frame{0, 0, 1};
  HeightGrid grid;
  /// surface_material[nz - 1][nx - 1], material of each ground cell; empty: all are material 0.
  std::vector<std::uint8_t> surface_material;
  /// raster_gamma[nz - 1][nx - 1], what gamma rasters say of each ground cell; empty: nothing. Positive:
  /// times its material's cross section, 1 where they say nothing. Negative: in place of that, a constant
  /// gamma of its amount.
  std::vector<float> raster_gamma;
  Buildings buildings;
  LoadReport report;

  std::size_t cell_index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.nx - 1) + static_cast<std::size_t>(i);
  }
  std::uint8_t material_of_cell(int i, int j) const {
    return surface_material.empty() ? std::uint8_t{0} : surface_material[cell_index(i, j)];
  }
  float raster_gamma_of_cell(int i, int j) const {
    return raster_gamma.empty() ? 1.0F : raster_gamma[cell_index(i, j)];
  }
};

/// How fine the ground of a scene can be.
struct SourcePosting {
  double posting_m = 0;  ///< between posts of the finest elevation model; 0: made-up ground, which has none
  double area_m2 = 0;    ///< of the rectangle that would be loaded
};

/// Opens the elevation models without reading heights. Throws InputError.
SourcePosting source_posting(const WorldSpec& spec);

/// Longitude and latitude of the centre of the DEMs' union. Throws InputError that names the file.
LonLat dem_centre(const TerrainSpec& terrain);

/// Loads terrain, surfaces and buildings. Throws InputError that names the file and what is wrong.
World load_world(const WorldSpec& spec, const Progress& progress = {});

/// Fills world.grid and its part of world.report from [terrain]; world.frame must be set. Throws InputError.
void load_ground(World& world, const WorldSpec& spec, const Progress& progress);

}  // namespace obliq
