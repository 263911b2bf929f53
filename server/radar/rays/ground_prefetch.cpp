#include "server/radar/rays/ground_prefetch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec2.hpp>

namespace obliq {
namespace {

constexpr std::ptrdiff_t kFloatsALine = 16;  // 64 bytes
constexpr double kMostBytes = 1024 * 1024;

}  // namespace

void prefetch_ground(const HeightGrid& grid, const glm::dvec3& antenna_m, SinCos left, SinCos right,
                     double reach_m) {
  const double cells_far = reach_m / grid.cell_m;
  const double sin_width = std::abs(left.sin * right.cos - left.cos * right.sin);
  // The triangle, and a line at both ends of each row.
  if (!(cells_far * (0.5 * cells_far * sin_width * sizeof(float) + 128) <= kMostBytes)) return;
  // In cells.
  const glm::dvec2 antenna((antenna_m.x - grid.x0_m) / grid.cell_m, (antenna_m.z - grid.z0_m) / grid.cell_m);
  const std::array<glm::dvec2, 3> corners{antenna, antenna + cells_far * glm::dvec2(left.sin, left.cos),
                                          antenna + cells_far * glm::dvec2(right.sin, right.cos)};
  const auto [lowest, highest] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
  const int last_row = static_cast<int>(std::clamp(std::ceil(highest), -1.0, grid.nz - 1.0));
  for (int j = static_cast<int>(std::clamp(std::floor(lowest), 0.0, static_cast<double>(grid.nz)));
       j <= last_row; ++j) {
    // What of the triangle lies within a cell of the row.
    double from = HUGE_VAL;
    double to = -HUGE_VAL;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2& a = corners[k];
      const glm::dvec2& b = corners[(k + 1) % 3];
      for (const double row : {std::clamp(j - 1.0, lowest, highest), std::clamp(j + 1.0, lowest, highest)}) {
        if ((row < a.y) == (row < b.y) && row != a.y && row != b.y) continue;
        const double x = a.y == b.y ? a.x : a.x + (b.x - a.x) * ((row - a.y) / (b.y - a.y));
        from = std::min(from, x);
        to = std::max(to, x);
      }
    }
    const auto first = static_cast<std::ptrdiff_t>(std::clamp(from - 1, 0.0, grid.nx - 1.0));
    const auto last = static_cast<std::ptrdiff_t>(std::clamp(to + 2, 0.0, grid.nx - 1.0));
    const float* const heights = grid.y_m.data() + grid.index(0, j);
    for (std::ptrdiff_t i = first; i < last + kFloatsALine; i += kFloatsALine)
      __builtin_prefetch(heights + std::min(i, last), 0, 2);
  }
}

}  // namespace obliq
