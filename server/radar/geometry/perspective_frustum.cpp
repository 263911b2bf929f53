#include "server/radar/geometry/perspective_frustum.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <numbers>

#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

/// Slant range at which the edge line above row `row` (0 = the top edge) meets ground below_m under the
/// antenna.
double range_of_edge_m(const PerspectiveFrustum& frustum, double row, double below_m) {
  const glm::dvec3 d = frustum.direction((frustum.columns - 1) / 2.0, row - 0.5);
  return below_m * std::hypot(d.y, d.z) / -d.y;
}

}  // namespace

glm::dvec3 PerspectiveFrustum::direction(double column, double row) const {
  const double x = column_x_m(column);
  const double y = row_y_m(row);
  if (kind == FrustumKind::oblique) return {x, -near_m, y};
  const double sin_pitch = std::sin(pitch_rad);
  const double cos_pitch = std::cos(pitch_rad);
  return {x, y * cos_pitch - near_m * sin_pitch, near_m * cos_pitch + y * sin_pitch};
}

double PerspectiveFrustum::wide_solid_angle_sr(double column, double row) const {
  const auto corner = [&](double from_column, double from_row) {
    const double x = column_x_m(column + from_column);
    const double y = row_y_m(row + from_row);
    return bearing_of(x * y, near_m * std::sqrt(x * x + y * y + near_m * near_m));
  };
  // Rows run down the picture: the first row's edge has the greatest y.
  const double sum = corner(0.5, -0.5) - corner(-0.5, -0.5) - corner(0.5, 0.5) + corner(-0.5, 0.5);
  // Good to 1e-15 sr: what a plane seen edge-on leaves may be less.
  return std::max(0.0, sum);
}

glm::dmat4 PerspectiveFrustum::camera_from_antenna() const {
  const double s = std::sin(pitch_rad);
  const double c = kind == FrustumKind::oblique ? 0 : std::cos(pitch_rad);
  // Columns are the images of right, up and ahead. Camera up is (0, c, s), its axis (0, -s, c), and GLM looks
  // along -z: this flip is where the paper's left-handed axes become right-handed.
  glm::dmat4 m(1.0);
  m[0] = glm::dvec4(1, 0, 0, 0);
  m[1] = glm::dvec4(0, c, s, 0);
  m[2] = glm::dvec4(0, s, -c, 0);
  return m;
}

glm::dmat4 PerspectiveFrustum::clip_from_camera() const {
  // A flat box has D_f = D_n; the depth range only has to be non-empty, nothing is clipped by it.
  const double far = std::max(far_m, near_m * (1 + 1e-6));
  return glm::frustumRH_NO(left_m, right_m, bottom_m, top_m, near_m, far);
}

PerspectiveFrustum symmetric_frustum(const SectorBox& box, double sector_rad, int columns, int rows) {
  const double far_z = box.near_z_m + box.depth_m;
  // The point of the box that stands highest in the camera's vertical plane: its far top edge, or the near
  // top edge when the ground rises above the antenna.
  const double highest_z = box.kappa_m >= 0 ? far_z : box.near_z_m;
  const double far_depression = std::atan2(box.kappa_m, highest_z);
  const double close_depression = std::atan2(box.antenna_above_bottom_m, box.near_z_m);
  PerspectiveFrustum f;
  f.kind = FrustumKind::symmetric;
  f.columns = columns;
  f.rows = rows;
  f.phi_rad = close_depression - far_depression;
  f.pitch_rad = far_depression + f.phi_rad / 2;
  // Eq. (8), corrected: the widest corner of the sector as the camera sees it.
  double tangent = 0;
  for (double g : {box.g_min_m, box.g_max_m}) {
    for (double below : {box.antenna_above_bottom_m, box.kappa_m}) {
      const double depth =
          g * std::cos(sector_rad / 2) * std::cos(f.pitch_rad) + below * std::sin(f.pitch_rad);
      const double across = g * std::sin(sector_rad / 2);
      if (across == 0) continue;
      if (!(depth > 1e-6 * across))
        throw InputError(
            "radar.sector_deg: a corner of the sector lies beside or behind the symmetric camera; allowed: a "
            "narrower sector, a lower antenna, or frustum.quality = \"standard\", the sweep");
      tangent = std::max(tangent, across / depth);
    }
  }
  // A sector without width still gets square pixels.
  const double half_height = std::tan(f.phi_rad / 2);
  if (tangent == 0) tangent = half_height * columns / rows;
  f.theta_rad = 2 * std::atan(tangent);
  f.near_m = std::hypot(box.antenna_above_bottom_m, box.near_z_m) * std::cos(f.phi_rad / 2);
  f.far_m = std::hypot(box.kappa_m, highest_z) * std::cos(f.phi_rad / 2);
  f.right_m = f.near_m * tangent;
  f.left_m = -f.right_m;
  f.top_m = f.near_m * half_height;
  f.bottom_m = -f.top_m;
  return f;
}

PerspectiveFrustum oblique_frustum(const SectorBox& box, int columns, int rows) {
  PerspectiveFrustum f;
  f.kind = FrustumKind::oblique;
  f.columns = columns;
  f.rows = rows;
  f.pitch_rad = std::numbers::pi / 2;
  f.near_m = box.kappa_m;
  f.far_m = box.kappa_m + box.height_m;
  f.elongation_m = std::max(box.near_z_m, 0.0) * box.height_m / box.antenna_above_bottom_m;
  f.right_m = box.width_m / 2;
  f.left_m = -f.right_m;
  f.bottom_m = box.near_z_m - f.elongation_m;
  f.top_m = box.near_z_m + box.depth_m;
  f.lens_shift_m = box.near_z_m + (box.depth_m - f.elongation_m) / 2;
  return f;
}

StepSizes slant_range_steps(const PerspectiveFrustum& frustum, double below_m) {
  const double rows = frustum.rows;
  return {range_of_edge_m(frustum, 0, below_m) - range_of_edge_m(frustum, 1, below_m),
          range_of_edge_m(frustum, rows - 1, below_m) - range_of_edge_m(frustum, rows, below_m)};
}

StepSizes flat_steps(FrustumKind kind, double height_m, double r_min_m, double r_max_m, int pixels) {
  const SectorBox box(height_m, 0, r_min_m, r_max_m, 0);
  return slant_range_steps(kind == FrustumKind::symmetric ? symmetric_frustum(box, 0, pixels, pixels)
                                                          : oblique_frustum(box, pixels, pixels),
                           height_m);
}

}  // namespace obliq
