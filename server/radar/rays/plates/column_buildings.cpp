#include "server/radar/rays/plates/column_buildings.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

/// Wider columns than 5 degrees are not divided: tangents stand for angles here.
constexpr double kWidest_rad = 0.0873;

/// A sub-column is at most this many range bins wide on the ground, so that a wall across the line of sight
/// falls into the right bins all along, and no sub-column is cut into more than kMostParts for it.
constexpr double kSubColumn_bins = 0.5;
constexpr int kMostParts = 4;

}  // namespace

ColumnBuildings::ColumnBuildings(const FramePlan& plan, int azimuth_bin, double sin_bearing,
                                 double cos_bearing, double width_rad)
    : sin_bearing_(sin_bearing), cos_bearing_(cos_bearing), width_rad_(width_rad) {
  if (width_rad > kWidest_rad) return;
  const Buildings& all = plan.scene().world().buildings;
  const glm::dvec3& antenna = plan.sector().antenna_m;
  for (const std::uint32_t b : plan.buildings_in(azimuth_bin)) {
    const Building& building = all.list[b];
    Standing here;
    here.building = b;
    here.near_m = HUGE_VAL;
    double left = HUGE_VAL;
    double right = -HUGE_VAL;
    bool ahead = true;
    for (std::uint32_t k = all.ring_start[building.first_ring];
         k < all.ring_start[building.first_ring + building.n_rings]; ++k) {
      const double x = static_cast<double>(all.ring_xz_m[k].x) - antenna.x;
      const double z = static_cast<double>(all.ring_xz_m[k].y) - antenna.z;
      const double along = x * sin_bearing + z * cos_bearing;
      ahead = ahead && along > 1;
      const double across = (x * cos_bearing - z * sin_bearing) / along;
      const double fraction = 0.5 + across / width_rad;
      left = std::min(left, fraction);
      right = std::max(right, fraction);
      if (fraction > 0 && fraction < 1) here.cuts.push_back(fraction);
      here.near_m = std::min(here.near_m, along);
      here.far_m = std::max(here.far_m, along);
    }
    // An outline that reaches around the antenna, or past it, is left to the column's own plane.
    if (!ahead || left >= 1 || right <= 0) continue;
    const double base = static_cast<double>(building.base_y_m) - antenna.y;
    const double roof = static_cast<double>(building.roof_y_m) - antenna.y;
    here.low_slope = std::min(base / here.near_m, base / here.far_m);
    here.high_slope = std::max(roof / here.near_m, roof / here.far_m);
    standing_.push_back(std::move(here));
  }
}

void ColumnBuildings::sub_columns_between(double low_slope, double high_slope, double range_spacing_m,
                                          std::vector<SubColumn>& sub_columns) const {
  sub_columns.clear();
  between_.clear();
  cuts_.clear();
  nearest_between_m_ = HUGE_VAL;
  for (const Standing& standing : standing_) {
    if (standing.low_slope >= high_slope || standing.high_slope <= low_slope) continue;
    between_.push_back(standing.building);
    cuts_.insert(cuts_.end(), standing.cuts.begin(), standing.cuts.end());
    nearest_between_m_ = std::min(nearest_between_m_, standing.near_m);
  }
  if (between_.empty()) return;
  cuts_.push_back(0);
  cuts_.push_back(1);
  std::sort(cuts_.begin(), cuts_.end());
  for (std::size_t k = 0; k + 1 < cuts_.size(); ++k) {
    const double width = cuts_[k + 1] - cuts_[k];
    if (!(width > 0)) continue;
    const double on_ground_m = width * width_rad_ * nearest_between_m_;
    const int parts = static_cast<int>(
        std::clamp(std::ceil(on_ground_m / (kSubColumn_bins * range_spacing_m)), 1.0, double{kMostParts}));
    for (int part = 0; part < parts; ++part) {
      const double middle = cuts_[k] + width * (part + 0.5) / parts;
      const double across = (middle - 0.5) * width_rad_;
      const double over_length = 1 / std::sqrt(1 + across * across);
      sub_columns.push_back({(sin_bearing_ + across * cos_bearing_) * over_length,
                             (cos_bearing_ - across * sin_bearing_) * over_length, width / parts});
    }
  }
}

}  // namespace obliq
