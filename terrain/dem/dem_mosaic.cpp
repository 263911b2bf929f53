#include "terrain/dem/dem_mosaic.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

#include "terrain/base/errors.h"
#include "terrain/base/stage_clock.h"
#include "terrain/base/units.h"
#include "terrain/dem/dem_window.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/dem/resample.h"
#include "terrain/grid_area.h"

namespace obliq {
namespace {

/// The tangent plane says nothing useful about places further from the origin than this.
constexpr double kNear_deg = 15;

struct DegreeBox {
  double west = HUGE_VAL, south = HUGE_VAL, east = -HUGE_VAL, north = -HUGE_VAL;

  /// Longitudes are brought to within half a turn of the given one first.
  void include(const LonLat& p, double near_deg) {
    const double longitude = p.longitude_deg + 360 * std::round((near_deg - p.longitude_deg) / 360);
    west = std::min(west, longitude);
    east = std::max(east, longitude);
    south = std::min(south, p.latitude_deg);
    north = std::max(north, p.latitude_deg);
  }

  std::string text() const {
    return fmt::format("longitude {:.4f} to {:.4f}, latitude {:.4f} to {:.4f}", west, east, south, north);
  }
};

DegreeBox box_of(const std::vector<Raster>& files) {
  DegreeBox box;
  // A raster's own edge runs on without jumps unless it crosses +-180; its first point is as good as any.
  const double near_deg = files[0].edge().empty() ? 0 : files[0].edge()[0].longitude_deg;
  for (const Raster& file : files) {
    // A file of more than half a turn in longitude cannot be brought near one of its corners.
    double west = HUGE_VAL, east = -HUGE_VAL;
    for (const LonLat& p : file.edge()) {
      west = std::min(west, p.longitude_deg);
      east = std::max(east, p.longitude_deg);
    }
    const bool wide = east - west > 180 && file.turn_columns() != 0;
    for (const LonLat& p : file.edge()) box.include(p, wide ? p.longitude_deg : near_deg);
  }
  return box;
}

/// World rectangle of one file; empty when part of its edge is too far away to say.
Rect extent_of(const Raster& file, const WorldFrame& frame) {
  const double longitude_deg = frame.origin_longitude_rad() / kDegree_rad;
  const double latitude_deg = frame.origin_latitude_rad() / kDegree_rad;
  Rect rect;
  for (const LonLat& p : file.edge()) {
    const double east_deg = std::remainder(p.longitude_deg - longitude_deg, 360.0);
    if (std::abs(east_deg) > kNear_deg * 4 || std::abs(p.latitude_deg - latitude_deg) > kNear_deg) return {};
    rect.include(world_xz_m(frame, p));
  }
  return rect;
}

constexpr Rect kEverywhere{-HUGE_VAL, -HUGE_VAL, HUGE_VAL, HUGE_VAL};

/// What the files of a mosaic fill and tell, one after the other.
struct Filling {
  HeightGrid& grid;
  const WorldFrame& frame;
  SourceErrors& errors;
  std::optional<Seams> seams;
  WaterCells* water = nullptr;
};

/// Reads what one file has for the grid and gives it to the unknown nodes.
void fill_from_file(Filling& to, const GeodeticLattice& geodetic, const Raster& file,
                    const std::optional<VerticalUnit>& unit, const Progress& progress) {
  HeightGrid& grid = to.grid;
  const PostLattice lattice = post_lattice(geodetic, file);
  // "Clearly coarser": a cell of two postings and more takes the mean of the posts it stands for.
  const int step = std::clamp(static_cast<int>(grid.cell_m / file.posting_m()), 1, 4096);
  const double turn = file.turn_columns();
  for (double turns : {0.0, -1.0, 1.0}) {
    if (turns != 0 && turn == 0) continue;
    const double shift_columns = turns * turn;
    const PixelRect rect = needed_pixels(lattice, grid, file, step, shift_columns);
    if (rect.empty()) continue;
    PostSample sample = to.errors.sample(file);
    const DemWindow window = read_window(file, rect, step, unit, progress, &sample);
    const std::vector<WorldPoint> posts = to.errors.place(sample, file, to.frame, grid);
    fill_from_window(grid, lattice, window, shift_columns, to.seams ? &*to.seams : nullptr);
    to.errors.compare(posts, grid);
    if (to.water) to.water->decide(grid, lattice, window, file.posting_m(), shift_columns);
  }
}

}  // namespace

DemMosaic::DemMosaic(const TerrainSpec& terrain) : terrain_(terrain) {
  const StageProbe probe(Stage::load);
  if (terrain.dem.empty())
    throw InputError("[terrain] dem: found no file; allowed: one raster or more, or synthetic ground");
  for (const std::string& path : terrain.dem) {
    files_.emplace_back(path, "[terrain] dem", terrain.crs);
    units_.push_back(height_unit(files_.back(), terrain.unit));
  }
}

std::vector<ElevationSource> DemMosaic::sources() const {
  std::vector<ElevationSource> sources;
  for (std::size_t n = 0; n < files_.size(); ++n)
    sources.push_back({file_name(files_[n].path()), units_[n].name, units_[n].assumed});
  return sources;
}

std::vector<std::string> DemMosaic::files() const {
  std::vector<std::string> all;
  for (const Raster& file : files_) {
    const std::vector<std::string> parts = file.files();
    all.insert(all.end(), parts.begin(), parts.end());
  }
  return all;
}

LonLat DemMosaic::centre() const {
  const DegreeBox box = box_of(files_);
  return {std::remainder((box.west + box.east) / 2, 360.0), (box.south + box.north) / 2};
}

SourceExtents DemMosaic::extents() const {
  SourceExtents extents("terrain.dem");
  for (const Raster& file : files_) extents.add(file.edge());
  if (!terrain_.area.empty()) extents.cut_to(terrain_.area);
  return extents;
}

Rect DemMosaic::extent(const WorldFrame& frame) const {
  Rect all;
  for (const Raster& file : files_) {
    const Rect rect = extent_of(file, frame);
    if (rect.empty()) return kEverywhere;
    all.include({rect.x0_m, rect.z0_m});
    all.include({rect.x1_m, rect.z1_m});
  }
  return all;
}

double DemMosaic::finest_posting_m(const WorldFrame& frame, const Rect& rect) const {
  double finest_m = HUGE_VAL;
  for (const Raster& file : files_) {
    const Rect own = extent_of(file, frame);
    if (!own.empty() && own.intersection(rect).empty()) continue;
    finest_m = std::min(finest_m, file.posting_m());
  }
  return finest_m;
}

DemAccuracy DemMosaic::accuracy(const WorldFrame& frame, const Rect& rect) const {
  DemAccuracy best;
  bool any = false;
  for (const Raster& file : files_) {
    const Rect own = extent_of(file, frame);
    if (!own.empty() && own.intersection(rect).empty()) continue;
    DemAccuracy accuracy = dem_accuracy(file);
    if (!any || accuracy.rmse_m < best.rmse_m) best = std::move(accuracy);
    any = true;
  }
  return best;
}

void DemMosaic::fill(HeightGrid& grid, const WorldFrame& frame, SourceErrors& errors,
                     const Progress& progress, WaterCells* water) const {
  const GeodeticLattice geodetic = geodetic_lattice(frame, {grid.x0_m, grid.z0_m, grid.x1_m(), grid.z1_m()});
  // One file keeps to its posts; between two of them there is ground that neither knows alone.
  Filling filling{grid, frame, errors, {}, water};
  if (files_.size() > 1) filling.seams.emplace(grid);
  for (std::size_t n = 0; n < files_.size(); ++n) {
    const auto share = [&](std::string_view stage, double fraction) {
      if (progress) progress(stage, (static_cast<double>(n) + fraction) / static_cast<double>(files_.size()));
    };
    try {
      fill_from_file(filling, geodetic, files_[n], terrain_.unit, share);
    } catch (const std::bad_alloc&) {
      files_[n].refuse("there is not enough memory for the part of it that the scene needs",
                       "a smaller [terrain] area, a shorter range or larger cells");
    }
  }
  if (filling.seams) filling.seams->close(grid);
  if (water && files_.size() > 1) water->settle(grid);
}

void DemMosaic::describe(CacheKey& key, const HeightGrid& grid, const WorldFrame& frame) const {
  key.add("west", grid.x0_m);
  key.add("south", grid.z0_m);
  key.add("cell", grid.cell_m);
  key.add("columns", std::to_string(grid.nx));
  key.add("rows", std::to_string(grid.nz));
  key.add("origin's longitude", frame.origin_longitude_rad());
  key.add("origin's latitude", frame.origin_latitude_rad());
  key.add("earth", frame.radius_factor());
  const GeodeticLattice geodetic = geodetic_lattice(frame, {grid.x0_m, grid.z0_m, grid.x1_m(), grid.z1_m()});
  for (const std::vector<double>& y_m : geodetic.y_m) key.add("heights of the lattice", y_m);
  for (const Raster& file : files_) {
    key.add("dem", file.path());
    key.add("unit", height_unit(file, terrain_.unit).metres);
    const PostLattice lattice = post_lattice(geodetic, file);
    for (int layer = 0; layer < 2; ++layer) {
      key.add("lattice's columns", lattice.column[layer]);
      key.add("lattice's rows", lattice.row[layer]);
    }
    const std::vector<std::string> parts = file.files();
    if (parts.empty()) key.refuse();
    for (const std::string& part : parts) key.add_file(part);
  }
}

void DemMosaic::refuse_no_ground(const WorldFrame& frame, const Rect& wanted) const {
  DegreeBox box;
  const double near_deg = frame.origin_longitude_rad() / kDegree_rad;
  for (double x_m : {wanted.x0_m, wanted.x1_m}) {
    for (double z_m : {wanted.z0_m, wanted.z1_m}) {
      const Geodetic g = frame.geodetic_from_world(
          WorldPoint{glm::dvec3(x_m, frame.ellipsoid_y_m(x_m, z_m) - frame.lift_m(x_m, z_m), z_m)});
      box.include({g.longitude_rad / kDegree_rad, g.latitude_rad / kDegree_rad}, near_deg);
    }
  }
  std::string names = files_[0].path();
  if (files_.size() > 1) names += fmt::format(" and {} more", files_.size() - 1);
  throw InputError(
      fmt::format("[terrain] dem: found no height in the wanted area ({}); {} covers {}; allowed: an antenna "
                  "and area on known ground of the elevation model",
                  box.text(), names, box_of(files_).text()));
}

}  // namespace obliq
