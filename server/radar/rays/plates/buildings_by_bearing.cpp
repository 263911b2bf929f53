#include "server/radar/rays/plates/buildings_by_bearing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/simd/exact_math.h"
#include "server/scene/tolerances.h"

namespace obliq {
namespace {

constexpr double kTurn_rad = 2 * std::numbers::pi;

/// A cell for so many buildings, and no more than kMostCells: most buildings are wider than finer ones.
constexpr std::size_t kBuildingsACell = 4;
constexpr std::size_t kMostCells = 1024;

}  // namespace

BuildingFan::BuildingFan(const FramePlan& plan, int azimuth_bin)
    : all_(plan.scene().world().buildings), sector_(plan.sector()) {
  const std::vector<std::uint32_t>& buildings = plan.buildings_in(azimuth_bin);
  cells_.resize(std::clamp<std::size_t>(buildings.size() / kBuildingsACell, 1, kMostCells));
  centre_rad_ = plan.bins().azimuth_edge_rad(azimuth_bin + 0.5);
  cells_a_rad_ = static_cast<double>(cells_.size()) / plan.bins().azimuth_width_rad;

  std::vector<Standing> sorted;
  for (const std::uint32_t b : buildings) sorted.push_back(standing(b));
  std::sort(sorted.begin(), sorted.end(), [](const Standing& p, const Standing& q) {
    return p.near_m != q.near_m ? p.near_m < q.near_m : p.building < q.building;
  });
  const double last = static_cast<double>(cells_.size()) - 1;
  for (const Standing& here : sorted) {
    const Silhouette seen = silhouette_of(all_, sector_, here.building);
    // A silhouette may lie beyond half a turn, and the bin's centre elsewhere.
    for (int turn = -1; turn <= 1; ++turn) {
      const double from = cell_number(seen.from_rad - kMargin_rad + turn * kTurn_rad);
      const double to = cell_number(seen.to_rad + kMargin_rad + turn * kTurn_rad);
      if (!(from <= last && to >= 0)) continue;
      const auto first_cell = static_cast<std::size_t>(std::max(0.0, from));
      const auto last_cell = static_cast<std::size_t>(std::min(last, to));
      for (std::size_t k = first_cell; k <= last_cell; ++k) {
        Cell& cell = cells_[k];
        if (!cell.buildings.empty() && cell.buildings.back().building == here.building) continue;
        cell.buildings.push_back(here);
        cell.longest_m = std::max(cell.longest_m, here.far_m - here.near_m);
      }
    }
  }
}

/// The farthest corner bounds the outline; the nearest point of an edge may be nearer than its corners.
BuildingFan::Standing BuildingFan::standing(std::uint32_t building) const {
  const std::uint32_t ring = all_.list[building].first_ring;
  double nearest = HUGE_VAL;
  double farthest = 0;
  double longest_edge = 0;
  std::uint32_t last = all_.ring_start[ring + 1] - 1;
  for (std::uint32_t k = all_.ring_start[ring]; k < all_.ring_start[ring + 1]; last = k++) {
    const glm::dvec2 corner(all_.ring_xz_m[k]);
    const double d = std::hypot(corner.x - sector_.antenna_m.x, corner.y - sector_.antenna_m.z);
    nearest = std::min(nearest, d);
    farthest = std::max(farthest, d);
    const glm::dvec2 before(all_.ring_xz_m[last]);
    longest_edge = std::max(longest_edge, std::hypot(corner.x - before.x, corner.y - before.y));
  }
  return {std::max(0.0, nearest - longest_edge / 2), farthest, building};
}

/// Not clamped: in doubles, a narrow bin makes numbers that fit no integer.
double BuildingFan::cell_number(double offset_rad) const {
  return std::floor((offset_rad - centre_rad_) * cells_a_rad_ + static_cast<double>(cells_.size()) / 2);
}

const BuildingFan::Cell& BuildingFan::cell(double sin_bearing, double cos_bearing) const {
  if (cells_.size() == 1) return cells_[0];
  const double offset = bearing_of(sin_bearing * sector_.cos_bearing - cos_bearing * sector_.sin_bearing,
                                   sin_bearing * sector_.sin_bearing + cos_bearing * sector_.cos_bearing);
  // Within half a turn of the bin's centre, and in the bin but for rounding.
  const double near_centre = centre_rad_ + std::remainder(offset - centre_rad_, kTurn_rad);
  const double last = static_cast<double>(cells_.size()) - 1;
  return cells_[static_cast<std::size_t>(std::clamp(cell_number(near_centre), 0.0, last))];
}

void BuildingFan::add_stretches(double from_m, double to_m, double sin_bearing, double cos_bearing,
                                std::vector<RoofSpan>& stretches) const {
  const Cell& here = cell(sin_bearing, cos_bearing);
  auto at = std::lower_bound(here.buildings.begin(), here.buildings.end(), from_m - here.longest_m,
                             [](const Standing& standing, double d) { return standing.near_m < d; });
  for (; at != here.buildings.end() && at->near_m <= to_m; ++at)
    if (at->far_m >= from_m)
      add_roof_spans(all_, at->building, sector_.antenna_m.x, sector_.antenna_m.z, sin_bearing, cos_bearing,
                     stretches);
}

}  // namespace obliq
