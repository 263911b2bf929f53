#pragma once
// The paper's two camera frusta, symmetric and oblique, in the corrected forms of PAPER.md.
//
// Antenna axes: right, up, ahead; the antenna at the origin. Both cameras have rows of constant (up, ahead)
// and a varying right component: a pixel's direction is (X, up(row), ahead(row)), not normalised. Row 0 is
// the far edge (the top of the picture), column 0 the left edge.
#include <algorithm>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "server/radar/geometry/sector.h"
#include "server/radar/settings.h"

namespace obliq {

/// Camera parameters in the paper's notation. Lengths in metres, angles in radians.
struct PerspectiveFrustum {
  FrustumKind kind = FrustumKind::oblique;
  int columns = 0;
  int rows = 0;
  double pitch_rad = 0;  ///< beta, downwards: eq. (6); 90 degrees for the oblique frustum
  double theta_rad = 0;  ///< horizontal field of view, eq. (8); symmetric only
  double phi_rad = 0;    ///< vertical field of view, eq. (9); symmetric only
  double near_m = 0;     ///< D_n: eq. (10) or (23), the viewing plane's distance
  double far_m = 0;      ///< D_f: eq. (11) or (24)
  double left_m = 0;     ///< viewing-plane edges, in camera axes x right, y up the picture
  double right_m = 0;
  double bottom_m = 0;
  double top_m = 0;
  double lens_shift_m = 0;  ///< psi, eq. (28): centre of the sensor from the optical axis; oblique only
  double elongation_m = 0;  ///< nu, eq. (26); oblique only

  double pixel_width_m() const { return (right_m - left_m) / columns; }
  double pixel_height_m() const { return (top_m - bottom_m) / rows; }
  double column_x_m(double column) const { return left_m + (column + 0.5) * pixel_width_m(); }
  double row_y_m(double row) const { return top_m - (row + 0.5) * pixel_height_m(); }

  /// Direction of a pixel centre in antenna axes, not normalised: its length is
  /// sqrt(X^2 + Y^2 + D_n^2) of the viewing-plane point (X, Y).
  glm::dvec3 direction(double column, double row) const;

  /// Solid angle of a pixel whose viewing-plane point is distance_m from the antenna: dX dY D_n / distance^3,
  /// which is off by less than a thousandth while the sides are at most 1/16 of the distance; beyond that,
  /// where a coarse pixel reaches far around the nadir and the form would exceed the whole sphere, the exact
  /// integral.
  double solid_angle_sr(double column, double row, double distance2_m2, double distance_m) const {
    if (distance2_m2 < wide_m2()) return wide_solid_angle_sr(column, row);
    return pixel_width_m() * pixel_height_m() * near_m / (distance2_m2 * distance_m);
  }
  /// Below this square of its distance a pixel is wide.
  double wide_m2() const {
    const double width = pixel_width_m();
    const double height = pixel_height_m();
    return 256 * std::max(width * width, height * height);
  }
  /// The integral over the pixel's rectangle: atan(X Y / (D_n sqrt(X^2 + Y^2 + D_n^2))) over its corners,
  /// opposite ones with the same sign.
  double wide_solid_angle_sr(double column, double row) const;

  /// Antenna axes (right, up, ahead) to camera axes (x right, y up the picture, -z ahead: GLM's right-handed
  /// view).
  glm::dmat4 camera_from_antenna() const;
  /// Eq. (4) in its corrected form: GLM's frustumRH_NO of the viewing-plane edges.
  glm::dmat4 clip_from_camera() const;
};

/// Eqs. (5) to (11). The caller has checked that the sector is below 180 degrees; throws InputError when the
/// sector cannot be seen by one symmetric camera (an edge behind it).
PerspectiveFrustum symmetric_frustum(const SectorBox& box, double sector_rad, int columns, int rows);

/// Eqs. (22) to (28). The caller has checked that kappa is positive.
PerspectiveFrustum oblique_frustum(const SectorBox& box, int columns, int rows);

/// Slant-range difference between the centre column's outermost pixel edges, far and near, over level ground
/// `below_m` under the antenna: the paper's eqs. (20), (21) for the symmetric and (29), (30) for the oblique
/// frustum, in the corrected forms of PAPER.md. Metres.
struct StepSizes {
  double far_m = 0;
  double near_m = 0;
};

StepSizes slant_range_steps(const PerspectiveFrustum& frustum, double below_m);

/// The paper's simplification: flat ground, no sector, r_min and r_max at the centre column.
StepSizes flat_steps(FrustumKind kind, double height_m, double r_min_m, double r_max_m, int pixels);

}  // namespace obliq
