#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "terrain/base/errors.h"
#include "terrain/base/parallel.h"
#include "terrain/base/units.h"
#include "terrain/cache/cache_key.h"
#include "terrain/cache/ground_cache.h"
#include "terrain/dem/dem_mosaic.h"
#include "terrain/dem/gdal_messages.h"
#include "terrain/dem/resample.h"
#include "terrain/dem/source_error.h"
#include "terrain/dem/synthetic.h"
#include "terrain/dem/water_cells.h"
#include "terrain/grid_area.h"
#include "terrain/world.h"

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
  if (!(cell_m >= kGridQuantum_m) || !std::isfinite(cell_m))
    throw InputError(fmt::format(
        "[terrain] cell_m: found {}; allowed: \"auto\" or a number of metres from 0.03125", cell_m));
  return round_to_quantum_m(cell_m);
}

GroundCache::Facts facts_of(const HeightGrid& grid, const std::vector<std::size_t>& filled,
                            const SourceError& source_error) {
  const auto absent = [](float y) { return std::isnan(y); };
  const auto kept = [&](std::size_t n) { return !std::isnan(grid.y_m[n]); };
  return {static_cast<std::uint64_t>(std::ranges::count_if(filled, kept)),
          static_cast<std::uint64_t>(std::ranges::count_if(grid.y_m, absent)),
          source_error,
          {}};
}

GroundCache::Facts load_synthetic(World& world, const WorldSpec& spec, const WantedArea& wanted) {
  if (wanted.rect.empty())
    throw InputError("[terrain] area: found none and no radar; allowed: synthetic ground needs one of them");
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
  world.report.notes.push_back(
      fmt::format("elevation covers {:.1f} % of {}; {:.1f} % of it has no known ground", 100 * covered,
                  spec.terrain.area.empty() ? "the discs that the radars reach in all directions, plus 25 %"
                                            : "[terrain] area",
                  100 * (1 - covered)));
}

/// To be raised when the same elevation models give other heights than before: the sum in
/// tests/unit/terrain/cache/ground_cache_test.cpp says when.
constexpr const char* kAlgorithm = "2";

CacheKey key_of(const DemMosaic& mosaic, const World& world, const Polygon& area, double fill_m, bool water) {
  CacheKey key;
  key.add("obliq grid, algorithm", kAlgorithm);
  key.add("libraries", terrain_library_versions());
  key.add("fill", fill_m);
  key.add("water", water ? "looked for" : "not looked for");
  for (const Ring& ring : area.rings) {
    std::vector<double> corners;
    for (const glm::dvec2& corner : ring) corners.insert(corners.end(), {corner.x, corner.y});
    key.add("area", corners);
  }
  mosaic.describe(key, world.grid, world.frame);
  return key;
}

/// Elevation models on their way to a grid, whose cells may have to become finer.
class DemLoader {
 public:
  DemLoader(World& world, const WorldSpec& spec, const WantedArea& wanted, const Progress& progress)
      : world_(world),
        spec_(spec),
        wanted_(wanted),
        progress_(progress),
        mosaic_(spec.terrain),
        cache_(spec.terrain.cache_folder, world.report.notes) {}

  GroundCache::Facts load() {
    world_.report.elevation = mosaic_.sources();
    world_.report.dem_files = mosaic_.files();
    const Rect covered = mosaic_.extent(world_.frame);
    rect_ = wanted_.rect.empty() ? covered : wanted_.rect.intersection(covered);
    if (rect_.empty()) mosaic_.refuse_no_ground(world_.frame, wanted_.rect);
    const double posting_m = mosaic_.finest_posting_m(world_.frame, rect_);
    fill_m_ =
        spec_.terrain.fill_void_m.value_or(std::max(kFill_m, kFillPostings * round_to_quantum_m(posting_m)));
    // An elevation model of a few posts still gets a grid: at least two nodes lie on any three cells.
    const double shorter_m = std::min(rect_.x1_m - rect_.x0_m, rect_.z1_m - rect_.z0_m);
    const double needed_m = std::min(std::max(posting_m, spec_.sampling_footprint_m), shorter_m / 3);
    const double cell_m = cell_size_m(spec_, needed_m);
    if (spec_.terrain.cell_m) return make(cell_m);
    return refine({mosaic_.accuracy(world_.frame, rect_), cell_m, spec_.sampling_footprint_m,
                   spec_.terrain.most_auto_posts});
  }

 private:
  /// Halves the cells until the grid is as good as the models, or a limit is met.
  GroundCache::Facts refine(const AutoCellLimits& limits) {
    const std::size_t notes = world_.report.notes.size();
    GroundCache::Facts facts = make(limits.coarsest_m);
    const double before_m = facts.source_error.p95_m;
    std::string left;
    double cell_m = limits.coarsest_m;
    while (true) {
      const double finer_m =
          finer_cell_m(limits, cell_m, static_cast<double>(world_.grid.y_m.size()), facts.source_error, left);
      if (finer_m == 0) break;
      world_.report.notes.resize(notes);  // of a grid that is not used
      cell_m = finer_m;
      facts = make(cell_m);
    }
    if (cell_m == limits.coarsest_m && left.empty()) return facts;
    std::string note = fmt::format(
        "terrain.cell_m = \"auto\": over cells of {:.4g} m 95 % of the elevation model's posts lie within "
        "{:.3g} m of the grid; wanted: {:.3g} m ({})",
        cell_m, facts.source_error.p95_m, allowed_error_m(limits.accuracy), limits.accuracy.product);
    if (cell_m < limits.coarsest_m)
      note += fmt::format("; over cells of {:.4g} m it was {:.3g} m", limits.coarsest_m, before_m);
    if (!left.empty()) note += "; half the size would take " + left;
    world_.report.notes.push_back(note);
    return facts;
  }

  CacheKey key() const {
    return key_of(mosaic_, world_, wanted_.polygon, fill_m_, spec_.terrain.water_material.has_value());
  }

  GroundCache::Facts make(double cell_m) {
    // As files are stamped, but for a few milliseconds.
    const double begin_s = to_seconds(std::chrono::system_clock::now().time_since_epoch());
    world_.grid = empty_grid(rect_, cell_m);
    CacheKey before;
    if (cache_.in_use()) {
      before = key();
      if (auto facts = cache_.load(before, world_.grid)) return std::move(*facts);
      std::ranges::fill(world_.grid.y_m, std::numeric_limits<float>::quiet_NaN());  // of a damaged file
    }
    SourceErrors errors(world_.grid);
    std::optional<WaterCells> water;
    if (spec_.terrain.water_material) water.emplace(world_.grid);
    mosaic_.fill(world_.grid, world_.frame, errors, progress_, water ? &*water : nullptr);
    const auto known = [](float y) { return !std::isnan(y); };
    if (std::none_of(world_.grid.y_m.begin(), world_.grid.y_m.end(), known))
      mosaic_.refuse_no_ground(world_.frame, rect_);
    const std::vector<std::size_t> filled = fill_voids(world_.grid, fill_m_);
    cut_to_polygon(world_.grid, wanted_.polygon);
    GroundCache::Facts facts = facts_of(world_.grid, filled, errors.summary(world_.grid));
    if (water) facts.water = water->bits();
    if (!cache_.in_use() || !spec_.terrain.cache_keeps || facts.posts_absent == world_.grid.y_m.size())
      return facts;
    // A file that was changed or exchanged while it was read makes a grid of neither version.
    const CacheKey after = key();
    if (after.text() == before.text() && after.newest_change_s() <= begin_s)
      cache_.store(before, world_.grid, facts);
    return facts;
  }

  World& world_;
  const WorldSpec& spec_;
  const WantedArea& wanted_;
  const Progress& progress_;
  const DemMosaic mosaic_;
  const GroundCache cache_;
  Rect rect_;
  double fill_m_ = 0;
};

}  // namespace

void load_ground(World& world, const WorldSpec& spec, const Progress& progress) {
  const TerrainSpec& terrain = spec.terrain;
  const std::optional<double>& fill_m = terrain.fill_void_m;
  if (fill_m && (!(*fill_m >= 0) || !std::isfinite(*fill_m)))
    throw InputError(fmt::format(
        "[terrain] fill_void_m: found {}; allowed: \"auto\" or a number of metres from 0", *fill_m));
  if (!std::isfinite(spec.sampling_footprint_m))
    throw InputError(
        fmt::format("sampling footprint: found {}; allowed: a number of metres", spec.sampling_footprint_m));
  const WantedArea wanted = wanted_area(spec, world.frame);
  GroundCache::Facts facts;
  if (terrain.synthetic != SyntheticKind::none) {
    facts = load_synthetic(world, spec, wanted);
  } else {
    facts = DemLoader(world, spec, wanted, progress).load();
  }
  world.report.posts = world.grid.y_m.size();
  world.report.posts_filled = facts.posts_filled;
  world.report.posts_absent = facts.posts_absent;
  world.report.source_error = facts.source_error;
  if (terrain.water_material)
    world.report.water_m2 =
        paint_water(world.grid, facts.water, *terrain.water_material, world.surface_material);
  note_heights(world);
  note_coverage(world, spec, wanted);
  if (world.report.posts_absent == world.report.posts)
    throw InputError(
        "[terrain] area: found no known ground inside it; allowed: an area on the elevation model");
}

}  // namespace obliq
