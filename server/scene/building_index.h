#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "terrain/world.h"

namespace obliq {

/// Which buildings stand in each block of 8 x 8 grid cells, by their bounding rectangles. Immutable.
class BuildingIndex {
 public:
  static constexpr int kCells = 8;

  explicit BuildingIndex(const World& world);

  bool empty() const { return buildings_.empty(); }
  std::size_t bytes() const { return (start_.capacity() + buildings_.capacity()) * sizeof start_[0]; }

  /// Buildings near a point in the plane; none off the grid.
  std::span<const std::uint32_t> near(double x_m, double z_m) const;

  /// Buildings of all blocks that the plane stretch from `from` to `to` comes near to, each once, rising.
  void along(const glm::dvec2& from_m, const glm::dvec2& to_m, std::vector<std::uint32_t>& found) const;

 private:
  std::span<const std::uint32_t> block(int i, int j) const;

  double x0_m_, z0_m_, block_m_;
  int nx_, nz_;
  std::vector<std::uint32_t> start_;      // [nx * nz + 1], into buildings_; empty without buildings
  std::vector<std::uint32_t> buildings_;  // block by block
};

/// Whether the point lies inside the building's solid by more than `margin_m`: from its sides, and below its
/// roof.
bool inside_building(const Buildings& all, std::uint32_t building, double x_m, double y_m, double z_m,
                     double margin_m);

}  // namespace obliq
