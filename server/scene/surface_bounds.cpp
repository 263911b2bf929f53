#include "server/scene/surface_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq {
namespace {

constexpr std::size_t kFewSquares = 64;  ///< of the last level
/// A building's outline may lie this far outside its corners' squares, by rounding.
constexpr double kAround_m = 0.01;

SurfaceBounds::Level larger_of(const SurfaceBounds::Level& smaller) {
  SurfaceBounds::Level level;
  level.cells = smaller.cells * SurfaceBounds::kLarger;
  level.nx = (smaller.nx - 1) / SurfaceBounds::kLarger + 1;
  level.nz = (smaller.nz - 1) / SurfaceBounds::kLarger + 1;
  level.highest_m.assign(static_cast<std::size_t>(level.nx) * static_cast<std::size_t>(level.nz),
                         -std::numeric_limits<float>::infinity());
  level.whole.assign(level.highest_m.size(), 1);
  for (int j = 0; j < smaller.nz; ++j) {
    for (int i = 0; i < smaller.nx; ++i) {
      const std::size_t to = level.index(i / SurfaceBounds::kLarger, j / SurfaceBounds::kLarger);
      const std::size_t from = smaller.index(i, j);
      level.highest_m[to] = std::max(level.highest_m[to], smaller.highest_m[from]);
      level.whole[to] &= smaller.whole[from];
    }
  }
  return level;
}

}  // namespace

SurfaceBounds::SurfaceBounds(const World& world, const TileBounds& fine) {
  Level& level = levels_.emplace_back();
  level.cells = fine.cells();
  level.nx = fine.tiles_x();
  level.nz = fine.tiles_z();
  for (int j = 0; j < level.nz; ++j) {
    for (int i = 0; i < level.nx; ++i) {
      level.highest_m.push_back(fine.tile(i, j).highest_m);
      level.whole.push_back(fine.tile(i, j).whole ? 1 : 0);
    }
  }
  whole_ = fine.whole();
  add_roofs(world);
  while (levels_.back().highest_m.size() > kFewSquares) levels_.push_back(larger_of(levels_.back()));
  highest_m_ = static_cast<double>(std::ranges::max(levels_.back().highest_m));
}

void SurfaceBounds::add_roofs(const World& world) {
  const Buildings& all = world.buildings;
  if (all.list.empty()) return;
  Level& level = levels_.front();
  roof_m_.assign(level.highest_m.size(), -std::numeric_limits<float>::infinity());
  const double square_m = level.cells * world.grid.cell_m;
  const auto square_at = [&](double at_m, double first_m, int n) {
    return static_cast<int>(std::clamp(std::floor((at_m - first_m) / square_m), 0.0, n - 1.0));
  };
  for (const Building& building : all.list) {
    const Rectangle around(all.outline(building));
    const glm::dvec2 low(around.low_m), high(around.high_m);
    if (!(low.x <= high.x)) continue;
    const int i1 = square_at(high.x + kAround_m, world.grid.x0_m, level.nx);
    const int j1 = square_at(high.y + kAround_m, world.grid.z0_m, level.nz);
    for (int j = square_at(low.y - kAround_m, world.grid.z0_m, level.nz); j <= j1; ++j) {
      for (int i = square_at(low.x - kAround_m, world.grid.x0_m, level.nx); i <= i1; ++i) {
        const std::size_t at = level.index(i, j);
        roof_m_[at] = std::max(roof_m_[at], building.roof_y_m);
        level.highest_m[at] = std::max(level.highest_m[at], building.roof_y_m);
      }
    }
  }
}

}  // namespace obliq
