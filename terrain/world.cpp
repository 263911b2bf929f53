#include "terrain/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "terrain/errors.h"
#include "terrain/grid_area.h"
#include "terrain/synthetic.h"

namespace obliq {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;
constexpr double kSyntheticCell_m = 30;  ///< of synthetic ground when no radar says what it needs

WorldFrame frame_of(const WorldSpec& spec) {
  const LonLat& o = spec.origin;
  if (!(std::abs(o.latitude_deg) <= 90) || !(std::abs(o.longitude_deg) <= 540)) {
    throw InputError("[antenna] latitude_deg, longitude_deg: found " + std::to_string(o.latitude_deg) + ", " +
                     std::to_string(o.longitude_deg) + "; allowed: a position on the earth, in degrees");
  }
  if (!(spec.radius_factor > 0)) {
    throw InputError("[earth] radius_factor: found " + std::to_string(spec.radius_factor) +
                     "; allowed: a positive number, or inf for flat ground");
  }
  return WorldFrame(o.latitude_deg * kDegree_rad, o.longitude_deg * kDegree_rad, spec.radius_factor);
}

/// The given cell on the grid's quantum, or what the scene needs.
double cell_size_m(const WorldSpec& spec, double auto_m) {
  if (!spec.terrain.cell_m) return round_to_quantum_m(std::max(1.0, auto_m));
  const double cell_m = *spec.terrain.cell_m;
  if (!(cell_m >= kGridQuantum_m) || !std::isfinite(cell_m)) {
    throw InputError("[terrain] cell_m: found " + std::to_string(cell_m) +
                     "; allowed: \"auto\" or a number of metres from 0.03125");
  }
  return round_to_quantum_m(cell_m);
}

void synthetic_ground(World& world, const WorldSpec& spec) {
  const WantedArea wanted = wanted_area(spec, world.frame);
  if (wanted.rect.empty()) {
    throw InputError("[terrain] area: found none and no radar; allowed: synthetic ground needs one of them");
  }
  const double needed_m = spec.sampling_footprint_m > 0 ? spec.sampling_footprint_m : kSyntheticCell_m;
  world.grid = empty_grid(wanted.rect, cell_size_m(spec, needed_m));
  fill_synthetic(world.grid, spec.terrain.synthetic, spec.terrain.shape, world.frame);
  cut_to_polygon(world.grid, wanted.polygon);
}

void count_nodes(World& world) {
  world.report.posts = world.grid.y_m.size();
  world.report.posts_absent = static_cast<std::uint64_t>(
      std::count_if(world.grid.y_m.begin(), world.grid.y_m.end(), [](float y) { return std::isnan(y); }));
}

}  // namespace

LonLat dem_centre(const TerrainSpec& terrain) {
  if (terrain.dem.empty()) throw InputError("[terrain] dem: found none; allowed: at least one raster");
  throw InputError("[terrain] dem: elevation models are not read yet");
}

World load_world(const WorldSpec& spec, const Progress& progress) {
  World world;
  world.frame = frame_of(spec);
  if (progress) progress("terrain", 0);
  if (spec.terrain.synthetic == SyntheticKind::none) dem_centre(spec.terrain);
  synthetic_ground(world, spec);
  count_nodes(world);
  if (progress) progress("terrain", 1);
  return world;
}

}  // namespace obliq
