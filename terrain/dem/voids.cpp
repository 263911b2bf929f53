#include <algorithm>
#include <cmath>
#include <cstdint>

#include "terrain/dem/resample.h"

namespace obliq {
namespace {

/// Side in nodes of the largest all-void square with its upper right corner at each node; 0 on ground.
std::vector<std::uint16_t> void_squares(const HeightGrid& grid, int cap) {
  std::vector<std::uint16_t> side(grid.y_m.size(), 0);
  for (int j = 0; j < grid.nz; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      if (grid.node_known(i, j)) continue;
      int least = 0;
      if (i > 0 && j > 0)
        least = std::min(
            {side[grid.index(i - 1, j)], side[grid.index(i, j - 1)], side[grid.index(i - 1, j - 1)]});
      side[grid.index(i, j)] = static_cast<std::uint16_t>(std::min(cap, least + 1));
    }
  }
  return side;
}

/// Collects one void by flood fill and says whether it is a gap to be filled.
class Void {
 public:
  Void(const HeightGrid& grid, const std::vector<std::uint16_t>& side, std::vector<bool>& seen)
      : grid_(grid), side_(side), seen_(seen) {}

  void collect(std::size_t start) {
    nodes_.assign(1, start);
    seen_[start] = true;
    widest_ = 0;
    open_ = false;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const int i = static_cast<int>(nodes_[n] % static_cast<std::size_t>(grid_.nx));
      const int j = static_cast<int>(nodes_[n] / static_cast<std::size_t>(grid_.nx));
      widest_ = std::max(widest_, static_cast<int>(side_[nodes_[n]]));
      if (i == 0 || j == 0 || i == grid_.nx - 1 || j == grid_.nz - 1) open_ = true;
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) visit(i + di, j + dj);
      }
    }
  }

  bool is_gap(int most) const { return !open_ && widest_ <= most; }
  const std::vector<std::size_t>& nodes() const { return nodes_; }

 private:
  void visit(int i, int j) {
    if (i < 0 || j < 0 || i >= grid_.nx || j >= grid_.nz) return;
    const std::size_t n = grid_.index(i, j);
    if (seen_[n] || !std::isnan(grid_.y_m[n])) return;
    seen_[n] = true;
    nodes_.push_back(n);
  }

  const HeightGrid& grid_;
  const std::vector<std::uint16_t>& side_;
  std::vector<bool>& seen_;
  std::vector<std::size_t> nodes_;
  int widest_ = 0;
  bool open_ = false;
};

/// Steps from an unknown node to the first known one in a direction. The void is closed, so there is one.
int steps_to_ground(const HeightGrid& grid, int i, int j, int di, int dj) {
  int n = 0;
  do {
    ++n;
  } while (!grid.node_known(i + n * di, j + n * dj));
  return n;
}

float bridged(const HeightGrid& grid, std::size_t node) {
  const int i = static_cast<int>(node % static_cast<std::size_t>(grid.nx));
  const int j = static_cast<int>(node / static_cast<std::size_t>(grid.nx));
  double sum = 0;
  double weights = 0;
  for (const auto& [di, dj] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
    const int ahead = steps_to_ground(grid, i, j, di, dj);
    const int behind = steps_to_ground(grid, i, j, -di, -dj);
    const double a = grid.node_y_m(i + ahead * di, j + ahead * dj);
    const double b = grid.node_y_m(i - behind * di, j - behind * dj);
    const double weight = 1 / ((ahead + behind) * std::hypot(di, dj));
    sum += weight * (b + (a - b) * behind / (ahead + behind));
    weights += weight;
  }
  return static_cast<float>(sum / weights);
}

}  // namespace

std::vector<std::size_t> fill_voids(HeightGrid& grid, double widest_m) {
  std::vector<std::size_t> filled;
  const int most = static_cast<int>(std::min(30000.0, std::floor(widest_m / grid.cell_m)));
  const bool any = std::any_of(grid.y_m.begin(), grid.y_m.end(), [](float y) { return std::isnan(y); });
  if (most < 1 || !any) return filled;
  const std::vector<std::uint16_t> side = void_squares(grid, most + 1);
  std::vector<bool> seen(grid.y_m.size(), false);
  Void gap(grid, side, seen);
  for (std::size_t n = 0; n < grid.y_m.size(); ++n) {
    if (seen[n] || !std::isnan(grid.y_m[n])) continue;
    gap.collect(n);
    if (gap.is_gap(most)) filled.insert(filled.end(), gap.nodes().begin(), gap.nodes().end());
  }
  std::vector<float> heights;
  heights.reserve(filled.size());
  for (std::size_t n : filled) heights.push_back(bridged(grid, n));
  for (std::size_t k = 0; k < filled.size(); ++k) grid.y_m[filled[k]] = heights[k];
  return filled;
}

}  // namespace obliq
