#include "server/radar/rays/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/radar/geometry/silhouettes.h"
#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

// In units of ask(): a line of posts without them, and a building's bounds with its place in the order.
constexpr std::ptrdiff_t kALine = 4;
constexpr int kABuilding = 40;

}  // namespace

GroundClearance::GroundClearance(const HeightGrid& grid, const glm::dvec3& antenna_m, SinCos left,
                                 SinCos right)
    : grid_(grid), antenna_y_m_(antenna_m.y) {
  const double sin = left.sin + right.sin;
  const double cos = left.cos + right.cos;
  const double u = (antenna_m.x - grid.x0_m) / grid.cell_m;
  const double v = (antenna_m.z - grid.z0_m) / grid.cell_m;
  along_z_ = std::abs(cos) >= std::abs(sin);
  rising_ = (along_z_ ? cos : sin) > 0;
  start_ = along_z_ ? v : u;
  across_ = along_z_ ? u : v;
  lines_ = along_z_ ? grid.nz : grid.nx;
  others_ = along_z_ ? grid.nx : grid.nz;
  per_line_ = along_z_ ? grid.nx : 1;
  per_other_ = along_z_ ? 1 : grid.nx;
  const auto aside = [&](SinCos bearing) {
    return along_z_ ? bearing.sin / std::abs(bearing.cos) : bearing.cos / std::abs(bearing.sin);
  };
  left_ = std::min(aside(left), aside(right)) - kSlopeMargin;
  right_ = std::max(aside(left), aside(right)) + kSlopeMargin;
  // The strip that the antenna stands over, or the first one ahead of it; beyond the grid's end its last one.
  first_line_ = static_cast<int>(rising_ ? std::clamp(std::floor(start_), 0.0, lines_ - 2.0)
                                         : std::clamp(std::ceil(start_), 1.0, lines_ - 1.0));
}

/// The greatest height in one line of posts, of those that the strips on both sides of it need.
float GroundClearance::highest_of(int line) const {
  const double middle = (rising_ ? 1 : -1) * (line - start_);
  const double near = std::max(0.0, middle - 1);
  const double far = std::max(0.0, middle + 1);
  const double from = across_ + std::min(left_ * near, left_ * far);
  const double to = across_ + std::max(right_ * near, right_ * far);
  const double most = others_ - 1.0;
  const auto first = static_cast<std::ptrdiff_t>(std::clamp(from, 0.0, most));
  const auto last = static_cast<std::ptrdiff_t>(std::ceil(std::clamp(to, 0.0, most)));
  const float* const heights = grid_.y_m.data() + line * per_line_;
  float highest = -std::numeric_limits<float>::infinity();
  ask(last - first + kALine);
  for (std::ptrdiff_t k = first; k <= last; ++k) {
    const float height = heights[k * per_other_];
    highest = height > highest ? height : highest;  // unknown ground is not a number, and not greater
  }
  return highest;
}

/// The next strip, between two lines of posts; false at the grid's end.
bool GroundClearance::add_strip() {
  const int step = rising_ ? 1 : -1;
  const int near_line = first_line_ + step * static_cast<int>(slope_.size());
  const int far_line = near_line + step;
  if (far_line < 0 || far_line >= lines_) return false;
  if (slope_.empty()) near_highest_ = highest_of(near_line);
  const float far_highest = highest_of(far_line);
  const double highest = static_cast<double>(std::max(near_highest_, far_highest));
  const double above_m = highest - antenna_y_m_;
  near_highest_ = far_highest;
  const double far_m = step * (far_line - start_) * grid_.cell_m;
  const double distance_m = above_m > 0 ? near_m(slope_.size()) : far_m;
  double slope = -kInfinity;  // nothing is known, or all lies behind
  if (far_m > 0 && highest > -kInfinity) slope = above_m == 0 ? 0 : above_m / distance_m;
  const float up = std::nextafter(static_cast<float>(slope), std::numeric_limits<float>::infinity());
  own_slope_.push_back(slope == -kInfinity ? static_cast<float>(slope) : up);
  slope_.push_back(slope_.empty() ? own_slope_.back() : std::max(slope_.back(), own_slope_.back()));
  return true;
}

/// The strip that holds a distance along the axis.
std::size_t GroundClearance::strip_at(double ahead_m) const {
  const double cells = ahead_m / grid_.cell_m;
  const double strip =
      rising_ ? std::floor(start_ + cells) - first_line_ : first_line_ - std::ceil(start_ - cells);
  return static_cast<std::size_t>(std::clamp(strip, 0.0, static_cast<double>(lines_)));
}

/// Where a strip begins.
double GroundClearance::near_m(std::size_t strip) const {
  const int line = first_line_ + (rising_ ? 1 : -1) * static_cast<int>(strip);
  return std::max(0.0, (rising_ ? line - start_ : start_ - line) * grid_.cell_m);
}

double GroundClearance::free_range_m(const glm::dvec3& direction, double from_m) {
  const double ahead = std::abs(along_z_ ? direction.z : direction.x);
  const double slope = direction.y / ahead - kSlopeMargin;
  std::size_t k = last_;
  const std::vector<float>* reached = &slope_;
  if (from_m > 0) {
    k = strip_at(from_m * ahead);
    reached = &own_slope_;
    while (slope_.size() < k && add_strip()) {
    }
  } else {
    while (k > 0 && !(slope_[k - 1] < slope)) --k;
  }
  for (;; ++k) {
    if (k >= slope_.size() && !add_strip()) break;
    if (!((*reached)[k] < slope)) break;
  }
  if (from_m == 0) last_ = std::min(k, slope_.size());
  if (k >= slope_.size()) return kInfinity;
  const double near = near_m(k);
  return std::max(from_m, near > 0 ? near / ahead : 0);
}

RoofClearance::RoofClearance(const Buildings& all, const Sector& sector,
                             std::span<const std::uint32_t> buildings) {
  for (const std::uint32_t b : buildings) {
    ask(kABuilding);
    const BuildingBounds bounds = bounds_of(all, sector, b);
    roofs_.push_back({bounds.near_m, bounds.top_slope});
  }
  std::sort(roofs_.begin(), roofs_.end(), [](const Roof& a, const Roof& b) { return a.near_m < b.near_m; });
  double slope = -kInfinity;
  for (Roof& roof : roofs_) roof.slope = slope = std::max(slope, roof.slope);
}

double RoofClearance::free_range_m(const glm::dvec3& direction) const {
  if (roofs_.empty()) return kInfinity;
  const double level = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  const double slope = direction.y / level - kSlopeMargin;
  const auto first = std::partition_point(roofs_.begin(), roofs_.end(),
                                          [&](const Roof& roof) { return roof.slope < slope; });
  if (first == roofs_.end()) return kInfinity;
  return first->near_m > 0 ? first->near_m / level : 0;
}

}  // namespace obliq
