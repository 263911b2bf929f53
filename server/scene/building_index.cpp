#include "server/scene/building_index.h"

#include <algorithm>
#include <cmath>

namespace obliq {

BuildingIndex::BuildingIndex(const World& world)
    : x0_m_(world.grid.x0_m),
      z0_m_(world.grid.z0_m),
      block_m_(kCells * world.grid.cell_m),
      nx_((world.grid.nx - 2) / kCells + 1),
      nz_((world.grid.nz - 2) / kCells + 1) {
  const Buildings& all = world.buildings;
  if (all.list.empty()) return;
  struct Entry {
    std::size_t block;
    std::uint32_t building;
  };
  std::vector<Entry> entries;
  for (std::uint32_t b = 0; b < all.list.size(); ++b) {
    const std::uint32_t ring = all.list[b].first_ring;
    double west = HUGE_VAL, east = -HUGE_VAL, south = HUGE_VAL, north = -HUGE_VAL;
    for (std::uint32_t k = all.ring_start[ring]; k < all.ring_start[ring + 1]; ++k) {
      const glm::dvec2 corner(all.ring_xz_m[k]);
      west = std::min(west, corner.x);
      east = std::max(east, corner.x);
      south = std::min(south, corner.y);
      north = std::max(north, corner.y);
    }
    // A centimetre wider than the outline, for points just outside its walls.
    const auto at = [&](double value, double origin, int n) {
      return static_cast<int>(std::clamp(std::floor((value - origin) / block_m_), 0.0, n - 1.0));
    };
    for (int j = at(south - 0.01, z0_m_, nz_); j <= at(north + 0.01, z0_m_, nz_); ++j)
      for (int i = at(west - 0.01, x0_m_, nx_); i <= at(east + 0.01, x0_m_, nx_); ++i)
        entries.push_back(
            {static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i), b});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& p, const Entry& q) {
    return p.block != q.block ? p.block < q.block : p.building < q.building;
  });
  start_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(nz_) + 1, 0);
  buildings_.reserve(entries.size());
  for (const Entry& entry : entries) {
    ++start_[entry.block + 1];
    buildings_.push_back(entry.building);
  }
  for (std::size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
}

std::span<const std::uint32_t> BuildingIndex::block(int i, int j) const {
  if (start_.empty() || i < 0 || j < 0 || i >= nx_ || j >= nz_) return {};
  const std::size_t k =
      static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  return {buildings_.data() + start_[k], buildings_.data() + start_[k + 1]};
}

std::span<const std::uint32_t> BuildingIndex::near(double x_m, double z_m) const {
  const double u = (x_m - x0_m_) / block_m_;
  const double v = (z_m - z0_m_) / block_m_;
  if (!(u >= 0 && v >= 0 && u < nx_ && v < nz_)) return {};
  return block(static_cast<int>(u), static_cast<int>(v));
}

void BuildingIndex::along(const glm::dvec2& from_m, const glm::dvec2& to_m,
                          std::vector<std::uint32_t>& found) const {
  found.clear();
  if (start_.empty()) return;
  // Column by column of blocks: the rows between the stretch's ends there, one more on either side.
  const double u0 = (std::min(from_m.x, to_m.x) - x0_m_) / block_m_;
  const double u1 = (std::max(from_m.x, to_m.x) - x0_m_) / block_m_;
  const double rise = to_m.x != from_m.x ? (to_m.y - from_m.y) / (to_m.x - from_m.x) : 0;
  const int i0 = static_cast<int>(std::clamp(std::floor(u0), 0.0, nx_ - 1.0));
  const int i1 = static_cast<int>(std::clamp(std::floor(u1), 0.0, nx_ - 1.0));
  for (int i = i0; i <= i1; ++i) {
    double z0 = std::min(from_m.y, to_m.y);
    double z1 = std::max(from_m.y, to_m.y);
    if (to_m.x != from_m.x) {
      const double at_west = from_m.y + rise * (x0_m_ + i * block_m_ - from_m.x);
      const double at_east = from_m.y + rise * (x0_m_ + (i + 1) * block_m_ - from_m.x);
      z0 = std::max(z0, std::min(at_west, at_east));
      z1 = std::min(z1, std::max(at_west, at_east));
    }
    const int j0 = static_cast<int>(std::clamp(std::floor((z0 - z0_m_) / block_m_) - 1, 0.0, nz_ - 1.0));
    const int j1 = static_cast<int>(std::clamp(std::floor((z1 - z0_m_) / block_m_) + 1, 0.0, nz_ - 1.0));
    for (int j = j0; j <= j1; ++j) {
      const auto here = block(i, j);
      found.insert(found.end(), here.begin(), here.end());
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

bool inside_building(const Buildings& all, std::uint32_t building, double x_m, double y_m, double z_m,
                     double margin_m) {
  const Building& b = all.list[building];
  if (!(y_m < static_cast<double>(b.roof_y_m) - margin_m)) return false;
  // Crossings of a half-line eastwards, and the distance from every edge.
  bool inside = false;
  for (std::uint32_t ring = b.first_ring; ring < b.first_ring + b.n_rings; ++ring) {
    const std::uint32_t begin = all.ring_start[ring];
    const std::uint32_t end = all.ring_start[ring + 1];
    if (begin == end) continue;
    glm::dvec2 p(all.ring_xz_m[end - 1]);
    for (std::uint32_t k = begin; k < end; ++k) {
      const glm::dvec2 q(all.ring_xz_m[k]);
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
