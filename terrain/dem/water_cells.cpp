#include "terrain/dem/water_cells.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "terrain/base/parallel.h"

namespace obliq {

namespace {

std::size_t cells_across(const HeightGrid& grid) { return static_cast<std::size_t>(grid.nx - 1); }
std::size_t cells_of(const HeightGrid& grid) {
  return cells_across(grid) * static_cast<std::size_t>(grid.nz - 1);
}

/// Steps within this of whole metres are whole: heights are floats, 0.0005 m apart above 4096 m.
constexpr double kWholeStep_m = 1e-3;

/// Posts of one window by regions of neighbours, four to a post.
class Regions {
 public:
  Regions(const DemWindow& window, std::vector<std::uint8_t>& water)
      : window_(window), water_(water), seen_(window.height_m.size(), 0) {}

  /// Collects the posts that `joined` leads to from `start`. False where that has been seen before.
  template <typename Joined>
  bool collect(std::size_t start, const Joined& joined) {
    if (seen_[start] != 0) return false;
    posts_.assign(1, start);
    seen_[start] = 1;
    at_edge_ = false;
    shore_ = whole_steps_ = 0;
    const auto nx = static_cast<std::size_t>(window_.nx);
    const auto nz = static_cast<std::size_t>(window_.nz);
    for (std::size_t n = 0; n < posts_.size(); ++n) {
      const std::size_t at = posts_[n];
      const std::size_t c = at % nx;
      const std::size_t r = at / nx;
      at_edge_ = at_edge_ || window_.at_raster_edge(static_cast<int>(c), static_cast<int>(r));
      const auto visit = [&](std::size_t next) {
        if (!joined(height_m(at), height_m(next))) return note_shore(height_m(next) - height_m(at));
        if (seen_[next] != 0) return;
        seen_[next] = 1;
        posts_.push_back(next);
      };
      if (c > 0) visit(at - 1);
      if (c + 1 < nx) visit(at + 1);
      if (r > 0) visit(at - nx);
      if (r + 1 < nz) visit(at + nx);
    }
    return true;
  }

  void make_water() {
    for (const std::size_t at : posts_) water_[at] = 1;
  }

  double height_m(std::size_t at) const { return static_cast<double>(window_.height_m[at]); }
  std::size_t posts() const { return posts_.size(); }
  bool at_edge() const { return at_edge_; }  ///< of the raster
  /// The ground around lies mostly whole metres higher or lower.
  bool is_terrace() const { return 2 * whole_steps_ > shore_; }

 private:
  void note_shore(double step_m) {
    if (std::isnan(step_m)) return;
    ++shore_;
    if (std::abs(step_m - std::round(step_m)) < kWholeStep_m) ++whole_steps_;
  }

  const DemWindow& window_;
  std::vector<std::uint8_t>& water_;
  std::vector<std::uint8_t> seen_;
  std::vector<std::size_t> posts_;
  bool at_edge_ = false;
  std::size_t shore_ = 0;  ///< pairs of neighbours, of which one is in the region
  std::size_t whole_steps_ = 0;
};

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

std::vector<std::uint8_t> water_posts(const DemWindow& window, double posting_m) {
  std::vector<std::uint8_t> water(window.height_m.size(), 0);
  const double post_m2 = posting_m * posting_m * window.step * window.step;
  const auto area_m2 = [&](const Regions& region) { return static_cast<double>(region.posts()) * post_m2; };
  if (window.has_fractions) {
    Regions level(window, water);
    for (std::size_t at = 0; at < water.size(); ++at) {
      if (std::isnan(level.height_m(at))) continue;
      if (!level.collect(at, [](double a, double b) { return a == b; })) continue;
      if (area_m2(level) >= kLeastLevel_m2 && !level.is_terrace()) level.make_water();
    }
  }
  Regions sea(window, water);
  for (std::size_t at = 0; at < water.size(); ++at) {
    if (!(sea.height_m(at) >= kSeaLowest_m && sea.height_m(at) <= kSeaHighest_m)) continue;
    const auto joined = [](double a, double b) { return b < kSeaShore_m && std::abs(a - b) <= kSeaStep_m; };
    if (!sea.collect(at, joined)) continue;
    if (sea.at_edge() || area_m2(sea) >= kLeastSea_m2) sea.make_water();
  }
  return water;
}

}  // namespace obliq
