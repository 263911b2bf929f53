#include "server/radar/rays/plates/buildings_by_bearing.h"

#include <algorithm>
#include <cmath>

#include "server/radar/simd/lanes/exact_math.h"
#include "server/scene/tolerances.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// A cell for so many buildings, and no more than kMostCells: most buildings are wider than finer ones.
constexpr std::size_t kBuildingsACell = 4;
constexpr std::size_t kMostCells = 1024;

}  // namespace

BuildingsByBearing::BuildingsByBearing(const ScenePlan& plan, int azimuth_bin)
    : all_(plan.scene().world().buildings), sector_(plan.sector()) {
  const std::span<const std::uint32_t> buildings = plan.buildings_in(azimuth_bin);
  cells_.resize(std::clamp<std::size_t>(buildings.size() / kBuildingsACell, 1, kMostCells));
  centre_rad_ = plan.bins().azimuth_edge_rad(azimuth_bin + 0.5);
  cells_a_rad_ = static_cast<double>(cells_.size()) / plan.bins().azimuth_width_rad;

  std::vector<BuildingBounds> sorted;
  for (const std::uint32_t b : buildings) sorted.push_back(silhouette_of(all_, sector_, b));
  std::sort(sorted.begin(), sorted.end(), [](const BuildingBounds& p, const BuildingBounds& q) {
    return p.near_m != q.near_m ? p.near_m < q.near_m : p.building < q.building;
  });
  const double last = static_cast<double>(cells_.size()) - 1;
  for (const BuildingBounds& here : sorted) {
    // A building may lie beyond half a turn, and the bin's centre elsewhere.
    for (int turn = -1; turn <= 1; ++turn) {
      const double from = cell_number(here.from_rad - kMargin_rad + turn * kTurn_rad);
      const double to = cell_number(here.to_rad + kMargin_rad + turn * kTurn_rad);
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

/// Not clamped: in doubles, a narrow bin makes numbers that fit no integer.
double BuildingsByBearing::cell_number(double offset_rad) const {
  return std::floor((offset_rad - centre_rad_) * cells_a_rad_ + static_cast<double>(cells_.size()) / 2);
}

const BuildingsByBearing::Cell& BuildingsByBearing::cell(double sin_bearing, double cos_bearing) const {
  if (cells_.size() == 1) return cells_[0];
  const double offset = bearing_of(sin_bearing * sector_.cos_bearing - cos_bearing * sector_.sin_bearing,
                                   sin_bearing * sector_.sin_bearing + cos_bearing * sector_.cos_bearing);
  // Within half a turn of the bin's centre, and in the bin but for rounding.
  const double near_centre = centre_rad_ + std::remainder(offset - centre_rad_, kTurn_rad);
  const double last = static_cast<double>(cells_.size()) - 1;
  return cells_[static_cast<std::size_t>(std::clamp(cell_number(near_centre), 0.0, last))];
}

template <typename Visit>
void BuildingsByBearing::visit_between(const Cell& cell, double from_m, double to_m, const Visit& visit) {
  auto at = std::lower_bound(cell.buildings.begin(), cell.buildings.end(), from_m - cell.longest_m,
                             [](const BuildingBounds& bounds, double d) { return bounds.near_m < d; });
  for (; at != cell.buildings.end() && at->near_m <= to_m; ++at)
    if (at->far_m >= from_m && !visit(*at)) return;
}

void BuildingsByBearing::add_stretches(double from_m, double to_m, double sin_bearing, double cos_bearing,
                                       std::vector<RoofSpan>& stretches) const {
  visit_between(cell(sin_bearing, cos_bearing), from_m, to_m, [&](const BuildingBounds& bounds) {
    add_roof_spans(all_, bounds.building, sector_.antenna_m.x, sector_.antenna_m.z, sin_bearing, cos_bearing,
                   stretches);
    return true;
  });
}

bool BuildingsByBearing::any_between(double from_m, double to_m, double sin_bearing,
                                     double cos_bearing) const {
  bool any = false;
  visit_between(cell(sin_bearing, cos_bearing), from_m, to_m, [&](const BuildingBounds&) {
    any = true;
    return false;
  });
  return any;
}

}  // namespace obliq
