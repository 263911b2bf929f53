#include "server/radar/rays/first_hits.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <span>

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A clearance of a wider stretch of bearings costs less, and its rays start sooner.
constexpr double kMostCells = 8;        // across at the swath's end
constexpr double kMost_rad = 0.125;     // so that the stretch has one direction
constexpr double kMostClearances = 64;  // of an azimuth bin
/// After so many cells a ray queries its clearance again: the obstacle that it started for is behind.
constexpr int kStretch = 24;
/// Beyond this a ray has left any grid.
constexpr double kFar_m = 1e8;

}  // namespace

GroundFirstHits::GroundFirstHits(const ScenePlan& plan, AzimuthRange range, bool beyond_swath)
    : plan_(plan), first_bin_(range.first), beyond_swath_(beyond_swath) {
  const HeightGrid& grid = plan.scene().world().grid;
  const Sector& sector = plan.sector();
  const BinGrid& bins = plan.bins();
  const auto edge = [&](double bin) { return sincos_turns(plan.bearing_rad(bin) / (2 * std::numbers::pi)); };
  const double cells = bins.azimuth_width_rad * sector.r_max_m / grid.cell_m;
  clearances_a_bin_ = static_cast<std::size_t>(std::clamp(
      std::ceil(std::max(cells / kMostCells, bins.azimuth_width_rad / kMost_rad)), 1.0, kMostClearances));
  bin_turns_ = bins.azimuth_width_rad / (2 * std::numbers::pi);
  wide_ = bin_turns_ > 0.1;
  edges_.push_back(edge(range.first));
  for (int bin = range.first; bin < range.first + range.count; ++bin) {
    middle_rad_.push_back(plan.bearing_rad(bin + 0.5));
    last_clearance_.push_back(clearances_.size());
    ask(static_cast<std::int64_t>(20 * clearances_a_bin_));
    for (std::size_t k = 1; k <= clearances_a_bin_; ++k) {
      const SinCos left = edges_.back();
      edges_.push_back(edge(bin + static_cast<double>(k) / static_cast<double>(clearances_a_bin_)));
      clearances_.emplace_back(grid, sector.antenna_m, left, edges_.back());
    }
  }
  if (!plan.scene().world().buildings.list.empty())
    for (int bin = range.first; bin < range.first + range.count; ++bin)
      roofs_.emplace_back(plan.scene().world().buildings, sector, plan.buildings_in(bin));
}

/// The clearance of a ray in the wedge's azimuth bin number `bin`.
GroundClearance* GroundFirstHits::clearance_of(std::size_t bin, const glm::dvec3& direction) {
  if (clearances_a_bin_ == 1) return &clearances_[bin];
  const std::size_t first = bin * clearances_a_bin_;
  const std::size_t last = first + clearances_a_bin_ - 1;
  std::size_t& at = last_clearance_[bin];
  if (wide_) {
    const double turns = (bearing_of(direction.x, direction.z) - middle_rad_[bin]) / (2 * std::numbers::pi);
    const double part = 0.5 + (turns - nearest_integer(turns)) / bin_turns_;  // of the bin
    const auto n = static_cast<double>(clearances_a_bin_);
    at = first + static_cast<std::size_t>(std::clamp(std::floor(part * n), 0.0, n - 1));
  } else {
    // The last ray's or one beside it. Edge k is the left one of clearance k.
    const auto right_of = [&](std::size_t k) {
      return direction.x * edges_[k].cos - direction.z * edges_[k].sin >= 0;
    };
    while (at < last && right_of(at + 1)) ++at;
    while (at > first && !right_of(at)) --at;
  }
  return &clearances_[at];
}

/// Slant range beyond which a ray may meet buildings that the plan does not list; infinite: none.
double GroundFirstHits::unknown_from_m(const glm::dvec3& direction) const {
  if (!beyond_swath_ || plan_.scene().world().buildings.list.empty()) return kInfinity;
  return plan_.building_reach_m() / std::sqrt(direction.x * direction.x + direction.z * direction.z);
}

/// Where the walk of a ray that meets nothing before `from_m` starts: on the grid; infinite: nowhere.
double GroundFirstHits::on_grid_m(double from_m, const glm::dvec3& direction) const {
  const HeightGrid& grid = plan_.scene().world().grid;
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double x = antenna.x + from_m * direction.x;
  const double z = antenna.z + from_m * direction.z;
  if (x >= grid.x0_m && x <= grid.x1_m() && z >= grid.z0_m && z <= grid.z1_m()) return from_m;
  double to = kInfinity;
  const auto within = [&](double at, double rate, double first, double last) {
    if (rate == 0) {
      if (at < first || at > last) to = -1;
      return;
    }
    from_m = std::max(from_m, ((rate > 0 ? first : last) - at) / rate);
    to = std::min(to, ((rate > 0 ? last : first) - at) / rate);
  };
  within(antenna.x, direction.x, grid.x0_m, grid.x1_m());
  within(antenna.z, direction.z, grid.z0_m, grid.z1_m());
  return from_m <= to ? from_m : kInfinity;
}

std::span<const std::uint16_t> GroundFirstHits::trace(const RayBatch& rays, RoughHit* hits) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const auto n = static_cast<std::size_t>(rays.n);
  const auto direction = [&](std::size_t k) {
    return glm::dvec3(rays.dir_x[k], rays.dir_y[k], rays.dir_z[k]);
  };
  std::size_t walking = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto bin = static_cast<std::size_t>(rays.azimuth_bin[k] - first_bin_);
    clearance_[k] = clearance_of(bin, direction(k));
    const double free_m = clearance_[k]->free_range_m(direction(k));
    roof_m_[k] = std::min(unknown_from_m(direction(k)),
                          roofs_.empty() ? kInfinity : roofs_[bin].free_range_m(direction(k)));
    range_m_[k] = kNone;
    // No walk where a roof comes first.
    from_m_[k] = roof_m_[k] < free_m ? kInfinity : on_grid_m(free_m, direction(k));
    if (from_m_[k] < kInfinity) walking_[walking++] = static_cast<std::uint16_t>(k);
  }
  while (walking > 0) {
    active_kernels().first_hits_on_ground(
        ground_view(plan_.scene().world().grid, antenna),
        {walking_.data(), static_cast<int>(walking), kStretch, kFar_m,
         plan_.scene().tiles().lowest_m() - antenna.y, rays.dir_x.data(), rays.dir_y.data(),
         rays.dir_z.data(), from_m_.data(), range_m_.data()});
    ask(kStretch * static_cast<std::int64_t>(walking) / 2);
    std::size_t unfinished = 0;
    for (std::size_t at = 0; at < walking; ++at) {
      const std::size_t k = walking_[at];
      if (range_m_[k] != FreeRays::kOutOfSteps) continue;
      range_m_[k] = kNone;
      const double free_m = clearance_[k]->free_range_m(direction(k), from_m_[k]);
      if (!(free_m < kInfinity)) continue;
      // A ray without clearance steps back, so as to reach the next edge from above.
      from_m_[k] = free_m > from_m_[k] ? free_m : from_m_[k] - plan_.scene().world().grid.cell_m / 2;
      walking_[unfinished++] = static_cast<std::uint16_t>(k);
    }
    walking = unfinished;
  }
  std::size_t left = 0;
  for (std::size_t at = 0; at < n; ++at) {
    const std::size_t k = rays.packet_order[at];
    hits[k] = {};
    if (range_m_[k] <= roof_m_[k]) {
      hits[k].kind = RoughHit::Kind::ground;
      // As float, like Embree's: refinement then gives the same bits, whichever tracer took the ray.
      hits[k].distance_m = static_cast<float>(range_m_[k]);
    } else if (roof_m_[k] < kInfinity) {
      left_[left++] = static_cast<std::uint16_t>(k);
    }
  }
  return std::span(left_).first(left);
}

FirstHits::FirstHits(const ScenePlan& plan, AzimuthRange range, bool beyond_swath) : plan_(plan) {
  if (plan.scene().rays() == RayMethod::march && plan.extent().any)
    ground_.emplace(plan, range, beyond_swath);
}

void FirstHits::trace(const RayBatch& rays, RoughHit* hits) {
  by_embree_.fill(false);
  std::span<const std::uint16_t> left(rays.packet_order.data(), static_cast<std::size_t>(rays.n));
  if (ground_) left = ground_->trace(rays, hits);
  if (left.empty()) return;
  for (const std::uint16_t k : left) by_embree_[k] = true;
  plan_.scene().tracer().trace(plan_.sector().antenna_m, rays.dir_x.data(), rays.dir_y.data(),
                               rays.dir_z.data(), static_cast<int>(left.size()), hits, left.data());
}

}  // namespace obliq
