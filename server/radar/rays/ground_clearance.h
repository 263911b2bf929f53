#pragma once
#include <glm/vec3.hpp>
#include <vector>

#include "server/radar/simd/exact_math.h"
#include "terrain/height_grid.h"

namespace obliq {

/// A narrow stretch of bearings, and how high the ground in it stands at most, line of posts by line of
/// posts: tells how far a ray goes before it can meet any. Distances are along the grid's axis that the beam
/// goes along rather than across, so that a ray's height over them is a straight line.
class GroundBeam {
 public:
  /// Between two bearings that are much less than a right angle apart. The grid outlives the beam.
  GroundBeam(const HeightGrid& grid, const glm::dvec3& antenna_m, SinCos left, SinCos right);

  /// Slant range from from_m on before which a ray of the beam (unit direction) meets no ground; infinite: it
  /// meets none at all. Looks at the ground only as far as a ray has needed it.
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

}  // namespace obliq
