#include "terrain/dem/water_cells.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "terrain/base/parallel.h"
#include "terrain/dem/cell_places.h"
#include "terrain/dem/water.h"

namespace obliq {
namespace {

std::size_t cells_across(const HeightGrid& grid) { return static_cast<std::size_t>(grid.nx - 1); }
std::size_t cells_of(const HeightGrid& grid) {
  return cells_across(grid) * static_cast<std::size_t>(grid.nz - 1);
}

}  // namespace

WaterCells::WaterCells(const HeightGrid& grid) : states_(cells_of(grid), undecided) {}

void WaterCells::decide(const HeightGrid& grid, const PostLattice& lattice, const DemWindow& window,
                        double posting_m, double shift_columns) {
  const std::vector<std::uint8_t> posts = water_posts(window, posting_m);
  const bool any = std::ranges::find(posts, 1) != posts.end();
  for_each_row(grid.nz - 1, [&](int j) {
    std::uint8_t* states = states_.data() + static_cast<std::size_t>(j) * cells_across(grid);
    if (!any) {
      for (int i = 0; i < grid.nx - 1; ++i) {
        if (states[i] == undecided && grid.cell_known(i, j)) states[i] = land;
      }
      return;
    }
    for_each_cell_place(grid, j, lattice, [&](int i, double column, double row) {
      if (states[i] != undecided || !grid.cell_known(i, j)) return;
      double c = std::floor((column + shift_columns - window.column0) / window.step + 0.5);
      double r = std::floor((row - window.row0) / window.step + 0.5);
      // A cell's centre may lie a little outside of the posts that made its nodes.
      const bool inside = c >= -1 && r >= -1 && c <= window.nx && r <= window.nz;
      c = std::clamp(c, 0.0, window.nx - 1.0);
      r = std::clamp(r, 0.0, window.nz - 1.0);
      const bool wet = inside && posts[static_cast<std::size_t>(r) * static_cast<std::size_t>(window.nx) +
                                       static_cast<std::size_t>(c)] != 0;
      states[i] = wet ? water : land;
    });
  });
}

void WaterCells::settle(const HeightGrid& grid) {
  const std::size_t across = cells_across(grid);
  const auto at = [&](int i, int j) {
    return i < 0 || j < 0 || i >= grid.nx - 1 || j >= grid.nz - 1
               ? std::uint8_t{undecided}
               : states_[static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i)];
  };
  std::vector<std::size_t> open;
  for (int j = 0; j < grid.nz - 1; ++j) {
    for (int i = 0; i < grid.nx - 1; ++i) {
      if (at(i, j) == undecided && grid.cell_known(i, j))
        open.push_back(static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i));
    }
  }
  // From the decided cells inwards, a ring of cells a round.
  for (std::size_t before = open.size() + 1; open.size() < before;) {
    before = open.size();
    std::vector<std::pair<std::size_t, std::uint8_t>> found;
    for (const std::size_t n : open) {
      const int i = static_cast<int>(n % across);
      const int j = static_cast<int>(n / across);
      const std::uint8_t beside[] = {at(i - 1, j), at(i + 1, j), at(i, j - 1), at(i, j + 1)};
      if (std::ranges::find(beside, land) != std::end(beside)) {
        found.emplace_back(n, land);
      } else if (std::ranges::find(beside, water) != std::end(beside)) {
        found.emplace_back(n, water);
      }
    }
    for (const auto& [n, state] : found) states_[n] = state;
    std::erase_if(open, [&](std::size_t n) { return states_[n] != undecided; });
  }
}

std::vector<std::uint8_t> WaterCells::bits() const {
  if (std::ranges::find(states_, water) == states_.end()) return {};
  std::vector<std::uint8_t> bits((states_.size() + 7) / 8, 0);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    if (states_[n] == water) bits[n / 8] = static_cast<std::uint8_t>(bits[n / 8] | 1u << n % 8);
  }
  return bits;
}

double paint_water(const HeightGrid& grid, const std::vector<std::uint8_t>& bits, std::uint8_t material,
                   std::vector<std::uint8_t>& materials) {
  if (bits.empty()) return 0;
  materials.resize(cells_of(grid), 0);
  std::uint64_t cells = 0;
  for (int j = 0; j < grid.nz - 1; ++j) {
    for (int i = 0; i < grid.nx - 1; ++i) {
      const std::size_t n = static_cast<std::size_t>(j) * cells_across(grid) + static_cast<std::size_t>(i);
      if ((bits[n / 8] >> n % 8 & 1) == 0 || !grid.cell_known(i, j)) continue;
      materials[n] = material;
      ++cells;
    }
  }
  return static_cast<double>(cells) * grid.cell_m * grid.cell_m;
}

}  // namespace obliq
