#pragma once
// How far a ray goes before it can meet anything: bounds that cost less than a walk.
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "server/radar/geometry/sector.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/buildings/buildings.h"
#include "terrain/height_grid.h"

namespace obliq {

/// How far rays within a narrow stretch of bearings go before they can meet ground: a bound from the highest
/// post in each line of posts. Distances are along the grid's axis nearest to the bearings, so that a ray's
/// height over them is a straight line.
class GroundClearance {
 public:
  /// Between two bearings that are much less than a right angle apart. The grid must outlive it.
  GroundClearance(const HeightGrid& grid, const glm::dvec3& antenna_m, SinCos left, SinCos right);

  /// Slant range, from from_m on, before which a ray (unit direction) meets no ground; infinite: it meets
  /// none at all. Reads the ground only as far as a ray has needed it.
  double free_range_m(const glm::dvec3& direction, double from_m = 0);

 private:
  float highest_of(int line) const;
  bool add_strip();
  std::size_t strip_at(double ahead_m) const;
  double near_m(std::size_t strip) const;

  const HeightGrid& grid_;
  double antenna_y_m_;
  bool along_z_;
  bool rising_;            // towards greater numbers of the lines
  double start_, across_;  // the antenna in cells: along the axis, and across
  double left_, right_;    // cells across a cell along
  int lines_, others_;     // posts along the axis, and across
  std::ptrdiff_t per_line_, per_other_;
  int first_line_;          // the near line of the first strip
  float near_highest_ = 0;  // of the near line of the next one
  // Of the strips, rounded up: the greatest height over distance in each, and up to the end of each.
  std::vector<float> own_slope_;
  std::vector<float> slope_;
  std::size_t last_ = 0;  // where the last ray's look ended: the next is mostly near
};

/// How far a ray in any direction goes before it can meet one of some buildings: a bound from their distances
/// and heights.
class RoofClearance {
 public:
  RoofClearance(const Buildings& all, const Sector& sector, std::span<const std::uint32_t> buildings);

  /// Slant range before which a ray (unit direction) meets none of the buildings; infinite: it meets none at
  /// all.
  double free_range_m(const glm::dvec3& direction) const;

 private:
  struct Roof {
    double near_m;  // ground distance
    double slope;   // the greatest height over ground distance of this one and all before it
  };
  std::vector<Roof> roofs_;  // by distance
};

}  // namespace obliq
