#include "server/radar/ground_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/radar/ground_prefetch.h"
#include "server/radar/lane_kernels.h"
#include "server/scene/ray_answer.h"

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A wider beam has less to look at, and its rays start sooner.
constexpr double kMostCells = 8;     // across at the swath's end
constexpr double kMost_rad = 0.125;  // so that a beam has one direction
constexpr double kMostBeams = 256;   // of an azimuth bin

}  // namespace

GroundTrace::GroundTrace(const FramePlan& plan, AzimuthRange range) : plan_(plan), first_bin_(range.first) {
  const HeightGrid& grid = plan.scene().world().grid;
  const Sector& sector = plan.sector();
  const BinGrid& bins = plan.bins();
  const double cells = bins.azimuth_width_rad * sector.r_max_m / grid.cell_m;
  beams_a_bin_ = static_cast<std::size_t>(std::clamp(
      std::ceil(std::max(cells / kMostCells, bins.azimuth_width_rad / kMost_rad)), 1.0, kMostBeams));
  const auto edge = [&](double bin) { return sincos_turns(plan.bearing_rad(bin) / (2 * std::numbers::pi)); };
  const std::size_t n = static_cast<std::size_t>(range.count) * beams_a_bin_;
  for (std::size_t k = 0; k <= n; ++k)
    edges_.push_back(edge(range.first + static_cast<double>(k) / static_cast<double>(beams_a_bin_)));
  for (std::size_t k = 0; k < n; ++k) beams_.emplace_back(grid, sector.antenna_m, edges_[k], edges_[k + 1]);
  if (!plan.buildings_in(range).empty())
    for (int bin = range.first; bin < range.first + range.count; ++bin)
      roofs_.emplace_back(plan.scene().world().buildings, sector, plan.buildings_in(bin));
  prefetch_ground(grid, sector.antenna_m, edges_.front(), edges_.back(), sector.r_max_m);
}

/// The beam of a ray in the wedge's azimuth bin number `bin`.
std::size_t GroundTrace::beam_of(std::size_t bin, const glm::dvec3& direction) const {
  std::size_t beam = bin * beams_a_bin_;
  const std::size_t last = beam + beams_a_bin_ - 1;
  // Clockwise of the next beam's left edge.
  while (beam < last && direction.x * edges_[beam + 1].cos - direction.z * edges_[beam + 1].sin > 0) ++beam;
  return beam;
}

/// From where on a ray that meets nothing before `from_m` is to be walked: where it comes over the grid, if
/// it is not there yet; infinite: nowhere.
double GroundTrace::on_grid_m(double from_m, const glm::dvec3& direction) const {
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

std::span<const std::uint16_t> GroundTrace::trace(const RayBatch& rays, RoughHit* hits) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const auto n = static_cast<std::size_t>(rays.n);
  const auto direction = [&](std::size_t k) {
    return glm::dvec3(rays.dir_x[k], rays.dir_y[k], rays.dir_z[k]);
  };
  for (std::size_t k = 0; k < n; ++k) {
    const auto bin = static_cast<std::size_t>(rays.azimuth_bin[k] - first_bin_);
    const double free_m = beams_[beam_of(bin, direction(k))].free_range_m(direction(k));
    roof_m_[k] = roofs_.empty() ? kInfinity : roofs_[bin].free_range_m(direction(k));
    // Not walked where a roof comes first.
    from_m_[k] = roof_m_[k] < free_m ? kInfinity : on_grid_m(free_m, direction(k));
  }
  // Beyond this a ray has left any grid.
  constexpr double kFar_m = 1e8;
  lane_kernels().cast_ground(
      {lane_grid(plan_.scene().world().grid), antenna.x, antenna.y, antenna.z, kFar_m},
      {rays.n, rays.dir_x.data(), rays.dir_y.data(), rays.dir_z.data(), from_m_.data(), range_m_.data()});
  std::size_t left = 0;
  for (std::size_t at = 0; at < n; ++at) {
    const std::size_t k = rays.packet_order[at];
    const double range_m = range_m_[k];
    hits[k] = {};
    if (range_m == CastRays::kUnder) {
      hits[k] = walked_hit(plan_.scene(), antenna, direction(k));
    } else if (range_m <= roof_m_[k]) {
      hits[k].kind = RoughHit::Kind::ground;
      hits[k].distance_m = static_cast<float>(range_m);
    } else if (roof_m_[k] < kInfinity) {
      left_[left++] = static_cast<std::uint16_t>(k);
    }
  }
  return std::span(left_).first(left);
}

}  // namespace obliq
