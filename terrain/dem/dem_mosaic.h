#pragma once
// All elevation models of a scene as one: later ones fill where earlier ones know nothing.
#include <vector>

#include "terrain/base/parallel.h"
#include "terrain/cache/cache_key.h"
#include "terrain/dem/height_unit.h"
#include "terrain/dem/load_report.h"
#include "terrain/dem/raster.h"
#include "terrain/dem/source_error.h"
#include "terrain/dem/source_extents.h"
#include "terrain/dem/water_cells.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/polygon.h"
#include "terrain/world_spec.h"

namespace obliq {

class DemMosaic {
 public:
  /// Opens every file and checks its unit; reads no heights. Throws InputError.
  explicit DemMosaic(const TerrainSpec& terrain);

  /// The files and what their heights count in.
  std::vector<ElevationSource> sources() const;
  /// Every file that they consist of.
  std::vector<std::string> files() const;

  /// Centre of the union of the files' extents.
  LonLat centre() const;

  /// In degrees, file by file.
  SourceExtents extents() const;

  /// World rectangle around all files. A file that spans much of the earth counts as everywhere.
  Rect extent(const WorldFrame& frame) const;

  /// Distance between posts of the finest file that touches rect, metres.
  double finest_posting_m(const WorldFrame& frame, const Rect& rect) const;

  /// How good the best file is that touches rect.
  DemAccuracy accuracy(const WorldFrame& frame, const Rect& rect) const;

  /// Gives the grid's unknown nodes their heights, file by file, and then those on the seams
  /// between files; `errors` learns how far the surface then lies from the files' posts, `water`, where it is
  /// given, which cells are water. Throws InputError when a file cannot be read.
  void fill(HeightGrid& grid, const WorldFrame& frame, SourceErrors& errors, const Progress& progress,
            WaterCells* water = nullptr) const;

  /// Adds all that fill() makes this grid of: the files, and where their posts lie among the grid's nodes, as
  /// this machine works it out.
  void describe(CacheKey& key, const HeightGrid& grid, const WorldFrame& frame) const;

  /// Says that no file has heights in the wanted world rectangle, with both extents in degrees.
  [[noreturn]] void refuse_no_ground(const WorldFrame& frame, const Rect& wanted) const;

 private:
  TerrainSpec terrain_;
  std::vector<Raster> files_;
  std::vector<HeightUnit> units_;  ///< of the files
};

}  // namespace obliq
