#include "server/radar/rays/plates/pixel_plates.h"

#include <cmath>

#include "server/radar/visibility/wedge_visibility.h"

namespace obliq {
namespace {

/// No plate is walked farther than this many cells from its hit: pixels are a few cells long, and near the
/// horizon they would reach across the scene.
constexpr double kReach_cells = 64;

}  // namespace

PixelPlates::PixelPlates(const FramePlan& plan, AzimuthRange range, WedgeVisibility& profile)
    : plan_(plan), range_(range), profile_(profile), surface_(plan.scene().world(), plan.sector().antenna_m) {
  if (plan.camera().kind == FrustumKind::symmetric) {
    sin_pitch_ = std::sin(plan.camera().pitch_rad);
    cos_pitch_ = std::cos(plan.camera().pitch_rad);
  }
  for (int bin = range.first; bin < range.first + range.count; ++bin) fans_.emplace_back(plan, bin);
}

/// Half of the pixel's extent in slope, up / sqrt(X^2 + ahead^2), in its own vertical plane: the root of the
/// summed squares of what half a row and half a column change. A square pixel then has the same extent
/// whichever way it is turned to the plane, the one whose even spread has the pixel's own variance.
double PixelPlates::half_extent(std::uint32_t pixel) const {
  const PerspectiveFrustum& camera = plan_.camera();
  const auto columns = static_cast<std::uint32_t>(camera.columns);
  const double x = camera.column_x_m(pixel % columns);
  const double y = camera.row_y_m(pixel / columns);
  const double up = y * cos_pitch_ - camera.near_m * sin_pitch_;
  const double ahead = camera.near_m * cos_pitch_ + y * sin_pitch_;
  const double ground2 = x * x + ahead * ahead;
  const double ground3 = ground2 * std::sqrt(ground2);
  const double by_row = (cos_pitch_ * ground2 - up * ahead * sin_pitch_) / ground3 * camera.pixel_height_m();
  const double by_column = up * x / ground3 * camera.pixel_width_m();
  return std::sqrt(by_row * by_row + by_column * by_column) / 2;
}

void PixelPlates::take(const RayBatch& rays, std::size_t k, const ExactHit* hit,
                       std::vector<Sample>& samples) {
  if (!hit) return;
  const BinGrid& bins = plan_.bins();
  const double ground = std::sqrt(rays.dir_x[k] * rays.dir_x[k] + rays.dir_z[k] * rays.dir_z[k]);
  plate_.clear();
  double sin_bearing = 0;
  double cos_bearing = 1;
  if (ground > 0) {
    sin_bearing = rays.dir_x[k] / ground;
    cos_bearing = rays.dir_z[k] / ground;
    const SightPoint point{hit->slant_range_m * ground, hit->slant_range_m * rays.dir_y[k],
                           rays.dir_y[k] / ground};
    const double half = half_extent(rays.pixel[k]);
    const double reach_m = kReach_cells * plan_.scene().world().grid.cell_m;
    roofs_.clear();
    fans_[static_cast<std::size_t>(rays.azimuth_bin[k] - range_.first)].add_stretches(
        point.d_m - reach_m, point.d_m + reach_m, sin_bearing, cos_bearing, roofs_);
    if (!roofs_.empty()) roofs_ = disjoint_roofs(roofs_);
    surface_.aim(sin_bearing, cos_bearing, roofs_);
    visible_.clear();
    walk_out(surface_, point, point.slope + half, point.d_m + reach_m, visible_);
    walk_in(surface_, point, point.slope - half, point.d_m - reach_m, visible_);
    for (const SurfaceSegment& piece : visible_) plate_.add(bins, piece);
    plate_.drop_hidden(profile_.whole_marks(rays.azimuth_bin[k]).visible, bins.range_bin(hit->slant_range_m));
  }
  emit_plate(plan_, plate_, *hit, rays.solid_angle_sr[k], rays.azimuth_bin[k], sin_bearing, cos_bearing,
             samples);
}

}  // namespace obliq
