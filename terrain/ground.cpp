#include "terrain/ground.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "terrain/cache_key.h"
#include "terrain/dem_mosaic.h"
#include "terrain/errors.h"
#include "terrain/grid_area.h"
#include "terrain/ground_cache.h"
#include "terrain/library_versions.h"
#include "terrain/parallel.h"
#include "terrain/synthetic.h"
#include "terrain/voids.h"

namespace obliq {
namespace {

constexpr double kSyntheticCell_m = 30;  ///< of synthetic ground when no radar says what it needs

/// What is filled when the scene does not say: a missing post or two of coarse models, small lakes of fine
/// ones.
constexpr double kFill_m = 200;
constexpr double kFillPostings = 3;

/// The given cell on the grid's quantum, or what the scene needs.
double cell_size_m(const WorldSpec& spec, double auto_m) {
  if (!spec.terrain.cell_m) return round_to_quantum_m(auto_m);
  const double cell_m = *spec.terrain.cell_m;
  if (!(cell_m >= kGridQuantum_m) || !std::isfinite(cell_m)) {
    throw InputError("[terrain] cell_m: found " + std::to_string(cell_m) +
                     "; allowed: \"auto\" or a number of metres from 0.03125");
  }
  return round_to_quantum_m(cell_m);
}

GroundCache::Facts facts_of(const HeightGrid& grid, const std::vector<std::size_t>& filled,
                            const SourceError& source_error) {
  const auto absent = [](float y) { return std::isnan(y); };
  const auto kept = [&](std::size_t n) { return !std::isnan(grid.y_m[n]); };
  return {static_cast<std::uint64_t>(std::ranges::count_if(filled, kept)),
          static_cast<std::uint64_t>(std::ranges::count_if(grid.y_m, absent)), source_error};
}

GroundCache::Facts load_synthetic(World& world, const WorldSpec& spec, const WantedArea& wanted) {
  if (wanted.rect.empty()) {
    throw InputError("[terrain] area: found none and no radar; allowed: synthetic ground needs one of them");
  }
  const double needed_m = spec.sampling_footprint_m > 0 ? spec.sampling_footprint_m : kSyntheticCell_m;
  const double cell_m = cell_size_m(spec, std::max(1.0, needed_m));
  Rect rect = wanted.rect;
  if (cell_m > 0 && std::isfinite(cell_m)) {
    // Made-up ground has no edge of its own: the grid reaches out to whole cells.
    rect.x0_m = std::floor(rect.x0_m / cell_m) * cell_m;
    rect.z0_m = std::floor(rect.z0_m / cell_m) * cell_m;
    rect.x1_m = std::ceil(rect.x1_m / cell_m) * cell_m;
    rect.z1_m = std::ceil(rect.z1_m / cell_m) * cell_m;
  }
  world.grid = empty_grid(rect, cell_m);
  fill_synthetic(world.grid, spec.terrain.synthetic, spec.terrain.shape, world.frame);
  const SourceError source_error =
      synthetic_error(world.grid, spec.terrain.synthetic, spec.terrain.shape, world.frame);
  cut_to_polygon(world.grid, wanted.polygon);
  return facts_of(world.grid, {}, source_error);
}

/// How low and how high the known ground lies above the datum.
void note_heights(World& world) {
  const HeightGrid& grid = world.grid;
  struct Row {
    double lowest_m = HUGE_VAL, highest_m = -HUGE_VAL;
    int lowest = 0, highest = 0;
  };
  std::vector<Row> rows(static_cast<std::size_t>(grid.nz));
  for_each_row(grid.nz, [&](int j) {
    Row& row = rows[static_cast<std::size_t>(j)];
    for (int i = 0; i < grid.nx; ++i) {
      if (!grid.node_known(i, j)) continue;
      const double above_m = grid.node_y_m(i, j) - world.frame.datum_y_m(grid.node_x_m(i), grid.node_z_m(j));
      if (above_m < row.lowest_m) row.lowest_m = above_m, row.lowest = i;
      if (above_m > row.highest_m) row.highest_m = above_m, row.highest = i;
    }
  });
  const auto height_m = [&](int i, const Row& row) {
    const int j = static_cast<int>(&row - rows.data());
    return world.frame
        .geodetic_from_world({glm::dvec3(grid.node_x_m(i), grid.node_y_m(i, j), grid.node_z_m(j))})
        .height_m;
  };
  const Row& low = *std::ranges::min_element(rows, {}, &Row::lowest_m);
  const Row& high = *std::ranges::max_element(rows, {}, &Row::highest_m);
  if (!(low.lowest_m <= high.highest_m)) return;
  world.report.lowest_m = height_m(low.lowest, low);
  world.report.highest_m = height_m(high.highest, high);
}

void note_coverage(World& world, const WorldSpec& spec, const WantedArea& wanted) {
  if (wanted.rect.empty()) return;
  const double covered = covered_fraction(world.grid, wanted);
  if (covered > 0.9995) return;
  char note[200];
  std::snprintf(note, sizeof note, "elevation covers %.1f %% of %s; %.1f %% of it has no known ground",
                100 * covered,
                spec.terrain.area.empty() ? "the discs that the radars reach in all directions, plus 25 %"
                                          : "[terrain] area",
                100 * (1 - covered));
  world.report.notes.emplace_back(note);
}

/// To be raised when the same elevation models give other heights than before: the sum in
/// tests/unit/terrain_cache_test.cpp says when.
constexpr const char* kAlgorithm = "1";

CacheKey key_of(const DemMosaic& mosaic, const World& world, const Polygon& area, double fill_m) {
  CacheKey key;
  key.add("obliq grid, algorithm", kAlgorithm);
  key.add("libraries", terrain_library_versions());
  key.add("fill", fill_m);
  for (const Ring& ring : area.rings) {
    std::vector<double> corners;
    for (const glm::dvec2& corner : ring) corners.insert(corners.end(), {corner.x, corner.y});
    key.add("area", corners);
  }
  mosaic.describe(key, world.grid, world.frame);
  return key;
}

/// As files are stamped, but for a few milliseconds.
double clock_of_files_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// All elevation models on the grid.
GroundCache::Facts load_dem(World& world, const WorldSpec& spec, const WantedArea& wanted,
                            const Progress& progress) {
  const double begin_s = clock_of_files_s();
  const DemMosaic mosaic(spec.terrain);
  world.report.elevation = mosaic.sources();
  const Rect covered = mosaic.extent(world.frame);
  const Rect rect = wanted.rect.empty() ? covered : wanted.rect.intersection(covered);
  if (rect.empty()) mosaic.refuse_no_ground(world.frame, wanted.rect);
  const double posting_m = mosaic.finest_posting_m(world.frame, rect);
  // An elevation model of a few posts still gets a grid: at least two nodes lie on any three cells.
  const double shorter_m = std::min(rect.x1_m - rect.x0_m, rect.z1_m - rect.z0_m);
  const double needed_m = std::min(std::max(posting_m, spec.sampling_footprint_m), shorter_m / 3);
  world.grid = empty_grid(rect, cell_size_m(spec, needed_m));
  const double fill_m =
      spec.terrain.fill_void_m.value_or(std::max(kFill_m, kFillPostings * round_to_quantum_m(posting_m)));
  const GroundCache cache(spec.terrain.cache_folder, world.report.notes);
  CacheKey key;
  if (cache.in_use()) {
    key = key_of(mosaic, world, wanted.polygon, fill_m);
    if (const auto facts = cache.load(key, world.grid)) return *facts;
    std::ranges::fill(world.grid.y_m, std::numeric_limits<float>::quiet_NaN());  // of a damaged file
  }
  SourceErrors errors(world.grid);
  mosaic.fill(world.grid, world.frame, errors, progress);
  const auto known = [](float y) { return !std::isnan(y); };
  if (std::none_of(world.grid.y_m.begin(), world.grid.y_m.end(), known)) {
    mosaic.refuse_no_ground(world.frame, rect);
  }
  const std::vector<std::size_t> filled = fill_voids(world.grid, fill_m);
  cut_to_polygon(world.grid, wanted.polygon);
  const GroundCache::Facts facts = facts_of(world.grid, filled, errors.summary(world.grid));
  if (!cache.in_use() || !spec.terrain.cache_keeps || facts.posts_absent == world.grid.y_m.size())
    return facts;
  // A file that was changed or exchanged while it was read makes a grid of neither version.
  const CacheKey after = key_of(mosaic, world, wanted.polygon, fill_m);
  if (after.text() == key.text() && after.newest_change_s() <= begin_s) cache.store(key, world.grid, facts);
  return facts;
}

}  // namespace

void load_ground(World& world, const WorldSpec& spec, const Progress& progress) {
  const TerrainSpec& terrain = spec.terrain;
  const std::optional<double>& fill_m = terrain.fill_void_m;
  if (fill_m && (!(*fill_m >= 0) || !std::isfinite(*fill_m))) {
    throw InputError("[terrain] fill_void_m: found " + std::to_string(*fill_m) +
                     "; allowed: \"auto\" or a number of metres from 0");
  }
  if (!std::isfinite(spec.sampling_footprint_m)) {
    throw InputError("sampling footprint: found " + std::to_string(spec.sampling_footprint_m) +
                     "; allowed: a number of metres");
  }
  const WantedArea wanted = wanted_area(spec, world.frame);
  GroundCache::Facts facts;
  if (terrain.synthetic != SyntheticKind::none) {
    facts = load_synthetic(world, spec, wanted);
  } else {
    facts = load_dem(world, spec, wanted, progress);
  }
  world.report.posts = world.grid.y_m.size();
  world.report.posts_filled = facts.posts_filled;
  world.report.posts_absent = facts.posts_absent;
  world.report.source_error = facts.source_error;
  note_heights(world);
  note_coverage(world, spec, wanted);
  if (world.report.posts_absent == world.report.posts) {
    throw InputError(
        "[terrain] area: found no known ground inside it; allowed: an area on the elevation model");
  }
}

}  // namespace obliq
