#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "terrain/dem/source_error.h"

namespace obliq {

/// One elevation model: what its heights count in.
struct ElevationSource {
  std::string file;           ///< without its folder
  std::string unit;           ///< "m", "ft", or as the file has it
  bool unit_assumed = false;  ///< neither file nor scene names it
};

/// The heights that one source of buildings gave to those that stand.
struct BuildingHeights {
  std::string file;  ///< without its folder
  std::string field;
  std::string unit;         ///< of bare numbers in the field: "m" or "ft"
  std::uint64_t found = 0;  ///< heights; without any the three are 0
  double least_m = 0;
  double median_m = 0;
  double most_m = 0;
  std::uint64_t by_default = 0;  ///< buildings that got default_m
  double default_m = 0;
};

/// What loading found and did; every count is shown to the operator.
struct LoadReport {
  std::uint64_t posts = 0;                 ///< grid nodes
  std::uint64_t posts_filled = 0;          ///< void nodes filled by interpolation
  std::uint64_t posts_absent = 0;          ///< nodes left without ground (voids too wide, outside every DEM)
  std::vector<ElevationSource> elevation;  ///< none for made-up ground
  std::vector<std::string> dem_files;      ///< paths of every file that they consist of, in their order
  std::string world_sum;                   ///< of what the world is made from (terrain/world_sum.h)
  double lowest_m = 0;                     ///< known ground, above the datum
  double highest_m = 0;
  SourceError source_error;          ///< of the ground against the elevation models' posts
  double water_m2 = 0;               ///< ground found to be water in the elevation models
  std::uint64_t buildings_read = 0;  ///< features seen in the sources
  std::uint64_t buildings_kept = 0;  ///< prisms in the scene (a multipolygon makes several)
  std::uint64_t buildings_repaired = 0;
  std::uint64_t buildings_zero_area = 0;
  std::uint64_t buildings_duplicate = 0;
  std::uint64_t buildings_outside = 0;
  std::uint64_t buildings_around = 0;  ///< outlines that have the loaded area inside them
  std::uint64_t buildings_no_ground = 0;
  std::uint64_t buildings_unusable = 0;     ///< no polygon, fewer than three points, or not numbers
  std::uint64_t buildings_too_complex = 0;  ///< beyond outline.h's limits
  std::uint64_t buildings_too_wide = 0;     ///< beyond kWidest_m
  std::uint64_t buildings_slivers = 0;      ///< in the scene; terrain/buildings/odd_buildings.h
  std::uint64_t buildings_copies = 0;       ///< the same
  std::uint64_t buildings_default_height = 0;
  std::vector<BuildingHeights> building_heights;  ///< a source each
  std::uint64_t prisms_placed = 0;
  std::vector<std::string> notes;     ///< one sentence each, with numbers
  std::vector<std::string> warnings;  ///< the same, of what the operator is likely not to have meant
};

/// A path without its folder, which clients are not to learn.
std::string file_name(const std::string& path);

}  // namespace obliq
