#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "terrain/buildings.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/progress.h"
#include "terrain/source_error.h"
#include "terrain/world_spec.h"

namespace obliq {

/// What loading found and did; every count is shown to the operator.
struct LoadReport {
  std::uint64_t posts = 0;           ///< grid nodes
  std::uint64_t posts_filled = 0;    ///< void nodes filled by interpolation
  std::uint64_t posts_absent = 0;    ///< nodes left without ground (voids too wide, outside every DEM)
  SourceError source_error;          ///< of the ground against the elevation models' posts
  std::uint64_t buildings_read = 0;  ///< features seen in the sources
  std::uint64_t buildings_kept = 0;  ///< prisms in the scene (a multipolygon makes several)
  std::uint64_t buildings_repaired = 0;
  std::uint64_t buildings_zero_area = 0;
  std::uint64_t buildings_duplicate = 0;
  std::uint64_t buildings_outside = 0;
  std::uint64_t buildings_no_ground = 0;
  std::uint64_t buildings_unusable = 0;  ///< no polygon, fewer than three points, or not numbers
  std::uint64_t buildings_default_height = 0;
  std::uint64_t prisms_placed = 0;
  std::vector<std::string> notes;  ///< one sentence each, with numbers
};

/// Everything static that a radar can see. Immutable once loaded; shared by all threads.
struct World {
  WorldFrame frame{0, 0, 1};
  HeightGrid grid;
  /// surface_material[nz - 1][nx - 1], material of each ground cell; empty: all are material 0.
  std::vector<std::uint8_t> surface_material;
  Buildings buildings;
  LoadReport report;

  std::uint8_t material_of_cell(int i, int j) const {
    return surface_material.empty()
               ? std::uint8_t{0}
               : surface_material[static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.nx - 1) +
                                  static_cast<std::size_t>(i)];
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

}  // namespace obliq
