#include "server/truth/corner_integral.h"

#include <cmath>
#include <numbers>

#include "terrain/ground_slope.h"

namespace obliq {

CornerIntegral::CornerIntegral(const World& world, const std::vector<Material>& materials,
                               const ReferenceView& view, double step_m)
    : world_(world),
      table_(materials, view.vertical ? Polarisation::vertical : Polarisation::horizontal),
      view_(view),
      range_constant_(view.power_w * view.gain * view.gain * view.wavelength_m * view.wavelength_m /
                      std::pow(4 * std::numbers::pi, 3)),
      step_m_(step_m) {}

void CornerIntegral::add(const LitFoot& foot, double bearing_rad, double width_rad,
                         std::vector<BinShare>& shares) const {
  const double r_m = std::hypot(foot.d_m, foot.h_m);
  const double at = (r_m - view_.r_min_m) / (view_.r_max_m - view_.r_min_m) * view_.range_bins;
  if (!(at >= 0 && at < view_.range_bins)) return;
  const double sigma_m2 = width_rad * cross_section_per_rad(foot, bearing_rad);
  if (!(sigma_m2 > 0)) return;
  const double sine = foot.h_m / r_m;
  double power_w = range_constant_ * sigma_m2 / (view_.range_normalisation ? 1 : std::pow(r_m, 4));
  if (view_.two_way_gain) power_w *= view_.two_way_gain(sine, bearing_rad);
  shares.push_back({static_cast<int>(at), power_w, power_w * sine, power_w * foot.h_m, 0});
}

/// In world axes about the foot: e points outwards along the plane, the image's ray leaves the wall along
/// e - 2 (e . w) w.
double CornerIntegral::cross_section_per_rad(const LitFoot& foot, double bearing_rad) const {
  const double e_x = std::sin(bearing_rad), e_z = std::cos(bearing_rad);
  const double across = -(e_x * foot.normal_x + e_z * foot.normal_z);
  const double along = foot.normal_x * e_z - foot.normal_z * e_x;
  const double out_x = e_x + 2 * across * foot.normal_x, out_z = e_z + 2 * across * foot.normal_z;
  const double foot_x = view_.antenna_m.x + foot.d_m * e_x, foot_z = view_.antenna_m.z + foot.d_m * e_z;
  const double down = -foot.h_m / foot.d_m;
  const double level = 1 / std::sqrt(1 + down * down);
  double sum = 0;
  for (double before_m = step_m_ / 2; before_m < foot.lit_m; before_m += step_m_) {
    const double x = foot_x + before_m * out_x, z = foot_z + before_m * out_z;
    const GroundSlope slope = ground_slope_at(world_.grid, x, z);
    if (!slope.known) break;
    const double h = world_.grid.height_at_m(x, z) - view_.antenna_m.y;
    const double before = before_m / foot.d_m;
    // The ray from here to the image passes the wall's plane at h / (1 + before). The last step is a part.
    const double room_m = foot.roof_h_m - h / (1 + before);
    const double rise = down + slope.per_x * out_x + slope.per_z * out_z;
    double length_m = step_m_;
    if (rise > 0) length_m = std::min(length_m, step_m_ / 2 + room_m / rise);
    length_m = std::min(length_m, foot.lit_m - (before_m - step_m_ / 2));
    if (!(length_m > 0)) break;
    const CornerSight sight = CornerSight::over_ground(across, along, level, before, -h / foot.d_m);
    const FootSlope of_wall{slope.per_x * foot.normal_x + slope.per_z * foot.normal_z,
                            slope.per_x * foot.normal_z - slope.per_z * foot.normal_x};
    const std::uint8_t ground = world_.material_of_cell(slope.i, slope.j);
    sum += table_.lobe(ground, sight, of_wall) * table_.reflectivity(foot.material, ground, sight.across) *
           foot.d_m * (1 + before) * length_m *
           std::sqrt(1 + slope.per_x * slope.per_x + slope.per_z * slope.per_z);
    if (length_m < step_m_) break;
  }
  return sum;
}

}  // namespace obliq
