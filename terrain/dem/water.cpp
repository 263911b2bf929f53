#include "terrain/dem/water.h"

#include <cmath>

namespace obliq {
namespace {

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
