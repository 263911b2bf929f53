#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "terrain/world.h"

namespace obliq {

/// Which buildings stand in each block of 8 x 8 grid cells, by their bounding rectangles. A building that is
/// wider than a few blocks stands in larger ones, so that none is in more than 16. Immutable.
class BuildingIndex {
 public:
  static constexpr int kCells = 8;

  explicit BuildingIndex(const World& world);

  bool empty() const { return levels_.empty(); }
  std::size_t bytes() const;

  /// Whether `holds` is true of a building near a point in the plane; of none off the grid.
  template <typename Holds>
  bool any_near(double x_m, double z_m, Holds&& holds) const {
    for (const Level& level : levels_)
      for (const std::uint32_t building : level.near(x_m - x0_m_, z_m - z0_m_))
        if (holds(building)) return true;
    return false;
  }

  /// Buildings of all blocks that the plane stretch from `from` to `to` comes near to, each once, rising.
  void along(const glm::dvec2& from_m, const glm::dvec2& to_m, std::vector<std::uint32_t>& found) const;

 private:
  struct Blocks {
    int i0, i1, j0, j1;
  };

  /// Blocks of one size, places relative to the grid's corner.
  struct Level {
    double block_m;
    int nx, nz;
    std::vector<std::uint32_t> start;      // [nx * nz + 1], into buildings
    std::vector<std::uint32_t> buildings;  // block by block

    std::span<const std::uint32_t> block(int i, int j) const;
    std::span<const std::uint32_t> near(double x_m, double z_m) const;
    void along(const glm::dvec2& from_m, const glm::dvec2& to_m, std::vector<std::uint32_t>& found) const;
    Blocks under(const glm::dvec2& low_m, const glm::dvec2& high_m) const;
  };

  double x0_m_, z0_m_;
  std::vector<Level> levels_;  // the smallest blocks first; none without buildings
};

/// Whether the point lies inside the building's solid by more than `margin_m`: from its sides, and below its
/// roof.
bool inside_building(const Buildings& all, std::uint32_t building, double x_m, double y_m, double z_m,
                     double margin_m);

}  // namespace obliq
