// The area of a polygon in one pixel, by Green's theorem: each edge, taken row by row, adds or takes away
// what lies to its right in the row.
#include "terrain/dem/pixel_mean.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

using Corners = std::array<glm::dvec2, 4>;

/// Integral of clamp(u, 0, 1) from 0 to u.
double ramp(double u) { return u <= 0 ? 0 : u < 1 ? u * u / 2 : u - 0.5; }

/// Of a pixel from column to column + 1, the share to the right of a line that crosses its row from x0 to x1.
double right_of(double column, double x0, double x1) {
  constexpr double kUpright = 1e-6;  // a line this steep is taken as vertical: 1e-6 of a pixel's area
  if (std::abs(x1 - x0) < kUpright) return std::clamp(column + 1 - (x0 + x1) / 2, 0.0, 1.0);
  return (ramp(column + 1 - x0) - ramp(column + 1 - x1)) / (x1 - x0);
}

double twice_area(const Corners& p) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec2& a = p[k];
    const glm::dvec2& b = p[(k + 1) % 4];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum;
}

}  // namespace

PixelMean mean_under(const Corners& corners, const PixelValues& pixels) {
  // From here on pixel k reaches from k to k + 1.
  Corners p;
  for (std::size_t k = 0; k < 4; ++k)
    p[k] = corners[k] + 0.5 - glm::dvec2(pixels.rect.column0, pixels.rect.row0);
  const double area = std::abs(twice_area(p)) / 2;
  if (!(area > 0) || !std::isfinite(area)) return {};
  const auto [least_x, most_x] = std::minmax({p[0].x, p[1].x, p[2].x, p[3].x});
  const auto [least_y, most_y] = std::minmax({p[0].y, p[1].y, p[2].y, p[3].y});
  const double columns = pixels.rect.columns();
  const double rows = pixels.rect.rows();
  const int c0 = static_cast<int>(std::clamp(std::floor(least_x), 0.0, columns));
  const int c1 = static_cast<int>(std::clamp(std::ceil(most_x), 0.0, columns));
  const int r0 = static_cast<int>(std::clamp(std::floor(least_y), 0.0, rows));
  const int r1 = static_cast<int>(std::clamp(std::ceil(most_y), 0.0, rows));
  const double sign = twice_area(p) > 0 ? -1 : 1;  // of what lies to the right of an edge that goes down

  double sum = 0;
  double covered = 0;
  for (int r = r0; r < r1; ++r) {
    const float* const row =
        pixels.value.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(pixels.rect.columns());
    // The parts of the edges in this row.
    struct Piece {
      double height, x0, x1;
    };
    std::array<Piece, 4> pieces;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::dvec2& a = p[k];
      const glm::dvec2& b = p[(k + 1) % 4];
      const double from = std::clamp(a.y, static_cast<double>(r), r + 1.0);
      const double to = std::clamp(b.y, static_cast<double>(r), r + 1.0);
      if (from == to) continue;
      const double per_y = (b.x - a.x) / (b.y - a.y);
      pieces[n++] = {sign * (to - from), a.x + (from - a.y) * per_y, a.x + (to - a.y) * per_y};
    }
    for (int c = c0; c < c1; ++c) {
      const float value = row[c];
      if (std::isnan(value)) continue;
      double part = 0;
      for (std::size_t k = 0; k < n; ++k) part += pieces[k].height * right_of(c, pieces[k].x0, pieces[k].x1);
      sum += part * static_cast<double>(value);
      covered += part;
    }
  }
  if (!(covered > 0)) return {};
  return {sum / covered, covered / area};
}

}  // namespace obliq
