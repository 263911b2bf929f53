#include "server/scene/building_index.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace obliq {
namespace {

constexpr int kMostBlocks = 16;  ///< that a building is in
constexpr int kLarger = 8;       ///< times as many cells a side has the next level

/// A centimetre more than its bounding rectangle, for points just outside its walls.
void rectangle_of(const Buildings& all, const Building& building, glm::dvec2& low_m, glm::dvec2& high_m) {
  const Rectangle exact(all.outline(building));
  low_m = glm::dvec2(exact.low_m) - 0.01;
  high_m = glm::dvec2(exact.high_m) + 0.01;
}

}  // namespace

BuildingIndex::BuildingIndex(const World& world) : x0_m_(world.grid.x0_m), z0_m_(world.grid.z0_m) {
  const Buildings& all = world.buildings;
  if (all.list.empty()) return;
  for (int cells = kCells;; cells *= kLarger) {
    Level& level = levels_.emplace_back();
    level.block_m = cells * world.grid.cell_m;
    level.nx = (world.grid.nx - 2) / cells + 1;
    level.nz = (world.grid.nz - 2) / cells + 1;
    level.start.assign(static_cast<std::size_t>(level.nx) * static_cast<std::size_t>(level.nz) + 1, 0);
    if (level.nx * level.nz <= kMostBlocks) break;
  }
  // Counting sort: counts, shifted by one block, then prefix sums, then indices.
  const glm::dvec2 corner(x0_m_, z0_m_);
  const auto for_each_block = [&](auto&& use) {
    for (std::uint32_t b = 0; b < all.list.size(); ++b) {
      glm::dvec2 low, high;
      rectangle_of(all, all.list[b], low, high);
      for (Level& level : levels_) {
        const Blocks under = level.under(low - corner, high - corner);
        if ((under.i1 - under.i0 + 1) * (under.j1 - under.j0 + 1) > kMostBlocks) continue;
        for (int j = under.j0; j <= under.j1; ++j)
          for (int i = under.i0; i <= under.i1; ++i)
            use(level,
                static_cast<std::size_t>(j) * static_cast<std::size_t>(level.nx) +
                    static_cast<std::size_t>(i),
                b);
        break;
      }
    }
  };
  for_each_block([](Level& level, std::size_t block, std::uint32_t) { ++level.start[block + 1]; });
  for (Level& level : levels_) {
    for (std::size_t k = 1; k < level.start.size(); ++k) level.start[k] += level.start[k - 1];
    level.buildings.resize(level.start.back());
  }
  // Each block's start moves to its end, which is where the next one's was.
  for_each_block(
      [](Level& level, std::size_t block, std::uint32_t b) { level.buildings[level.start[block]++] = b; });
  for (Level& level : levels_) {
    std::copy_backward(level.start.begin(), level.start.end() - 1, level.start.end());
    level.start[0] = 0;
  }
}

std::size_t BuildingIndex::bytes() const {
  std::size_t n = 0;
  for (const Level& level : levels_) n += level.start.capacity() + level.buildings.capacity();
  return n * sizeof(std::uint32_t);
}

BuildingIndex::Blocks BuildingIndex::Level::under(const glm::dvec2& low_m, const glm::dvec2& high_m) const {
  const auto at = [&](double value, int n) {
    return static_cast<int>(std::clamp(std::floor(value / block_m), 0.0, n - 1.0));
  };
  return {at(low_m.x, nx), at(high_m.x, nx), at(low_m.y, nz), at(high_m.y, nz)};
}

std::span<const std::uint32_t> BuildingIndex::Level::block(int i, int j) const {
  if (i < 0 || j < 0 || i >= nx || j >= nz) return {};
  const std::size_t k =
      static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  return {buildings.data() + start[k], buildings.data() + start[k + 1]};
}

std::span<const std::uint32_t> BuildingIndex::Level::near(double x_m, double z_m) const {
  const double u = x_m / block_m;
  const double v = z_m / block_m;
  if (!(u >= 0 && v >= 0 && u < nx && v < nz)) return {};
  return block(static_cast<int>(u), static_cast<int>(v));
}

void BuildingIndex::along(const glm::dvec2& from_m, const glm::dvec2& to_m,
                          std::vector<std::uint32_t>& found) const {
  found.clear();
  const glm::dvec2 corner(x0_m_, z0_m_);
  for (const Level& level : levels_)
    if (!level.buildings.empty()) level.along(from_m - corner, to_m - corner, found);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

void BuildingIndex::Level::along(const glm::dvec2& from_m, const glm::dvec2& to_m,
                                 std::vector<std::uint32_t>& found) const {
  // Column by column of blocks: the rows between the stretch's ends there, one more on either side.
  const double u0 = (std::min(from_m.x, to_m.x)) / block_m;
  const double u1 = (std::max(from_m.x, to_m.x)) / block_m;
  const double rise = to_m.x != from_m.x ? (to_m.y - from_m.y) / (to_m.x - from_m.x) : 0;
  const int i0 = static_cast<int>(std::clamp(std::floor(u0), 0.0, nx - 1.0));
  const int i1 = static_cast<int>(std::clamp(std::floor(u1), 0.0, nx - 1.0));
  for (int i = i0; i <= i1; ++i) {
    double z0 = std::min(from_m.y, to_m.y);
    double z1 = std::max(from_m.y, to_m.y);
    if (to_m.x != from_m.x) {
      const double at_west = from_m.y + rise * (i * block_m - from_m.x);
      const double at_east = from_m.y + rise * ((i + 1) * block_m - from_m.x);
      z0 = std::max(z0, std::min(at_west, at_east));
      z1 = std::min(z1, std::max(at_west, at_east));
    }
    const int j0 = static_cast<int>(std::clamp(std::floor((z0) / block_m) - 1, 0.0, nz - 1.0));
    const int j1 = static_cast<int>(std::clamp(std::floor((z1) / block_m) + 1, 0.0, nz - 1.0));
    for (int j = j0; j <= j1; ++j) {
      const auto here = block(i, j);
      found.insert(found.end(), here.begin(), here.end());
    }
  }
}

bool inside_building(const Buildings& all, std::uint32_t building, double x_m, double y_m, double z_m,
                     double margin_m) {
  const Building& b = all.list[building];
  if (!(y_m < static_cast<double>(b.roof_y_m) - margin_m)) return false;
  // Crossings of a half-line eastwards, and the distance from every edge.
  bool inside = false;
  for (std::uint32_t ring = b.first_ring; ring < b.first_ring + b.n_rings; ++ring) {
    const std::span<const glm::vec2> corners = all.ring(ring);
    if (corners.empty()) continue;
    glm::dvec2 p(corners.back());
    for (const glm::vec2& corner : corners) {
      const glm::dvec2 q(corner);
      if ((p.y > z_m) != (q.y > z_m) && x_m < p.x + (q.x - p.x) * ((z_m - p.y) / (q.y - p.y)))
        inside = !inside;
      const glm::dvec2 edge = q - p;
      const double length2 = edge.x * edge.x + edge.y * edge.y;
      const double along = length2 > 0 ? ((x_m - p.x) * edge.x + (z_m - p.y) * edge.y) / length2 : 0;
      const double t = std::clamp(along, 0.0, 1.0);
      const double dx = x_m - p.x - t * edge.x;
      const double dz = z_m - p.y - t * edge.y;
      if (dx * dx + dz * dz <= margin_m * margin_m) return false;
      p = q;
    }
  }
  return inside;
}

}  // namespace obliq
