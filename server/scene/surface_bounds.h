#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/scene/tile_bounds.h"
#include "terrain/world.h"

namespace obliq {

/// How high anything stands in each square of a scene, ground and roofs, on levels of ever larger squares, so
/// that a profile passes over most of its way without a look at posts or outlines. Immutable.
class SurfaceBounds {
 public:
  /// Squares of `cells` x `cells` cells; those of the next level have kLarger times as many cells per side.
  struct Level {
    int cells = 0;
    int nx = 0, nz = 0;
    std::vector<float> highest_m;     ///< [nz][nx], world y; -infinity: nothing is known there
    std::vector<std::uint8_t> whole;  ///< [nz][nx], 1: all of its posts are known

    std::size_t index(int i, int j) const {
      return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
    }
  };
  static constexpr int kLarger = 4;

  /// fine: of the world's grid, in tiles of TileBounds::kFineCells.
  SurfaceBounds(const World& world, const TileBounds& fine);

  /// The smallest squares first.
  const std::vector<Level>& levels() const { return levels_; }
  /// Of the smallest squares, roofs alone; -infinity where no building stands.
  double highest_roof_m(int i, int j) const {
    return roof_m_.empty() ? -HUGE_VAL : static_cast<double>(roof_m_[levels_.front().index(i, j)]);
  }
  bool whole() const { return whole_; }
  /// World y over which nothing stands.
  double highest_m() const { return highest_m_; }

 private:
  void add_roofs(const World& world);

  std::vector<Level> levels_;
  std::vector<float> roof_m_;  ///< as of level 0; none without buildings
  bool whole_ = true;
  double highest_m_ = 0;
};

}  // namespace obliq
