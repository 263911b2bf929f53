#pragma once
// Closed forms: how much an ingredient of the model matters, and from where on. Level ground, an antenna h
// above it; every earth is named by its curvature 1/k (1 vacuum, 3/4 standard refraction, 0 flat), R is the
// earth's mean radius. tests/unit/accuracy/thresholds_test.cpp checks them against exact spheres.

namespace obliq {

/// How far the earth falls away from the tangent plane at a ground distance: g^2 / (2 k R), the parabola
/// through the sphere. 107.4 m at 37 km for k = 1, 80.6 m for k = 4/3.
double earth_drop_m(double ground_range_m, double curvature);

/// Slant range to the ground at that ground distance.
double ground_slant_range_m(double ground_range_m, double height_m, double curvature);

/// Power of a range bin at slant range r against that over a flat earth: 1 - r^2 / (2 k R h), 0 beyond the
/// horizon. A bin's power goes with d(sin depression)/dr of the ground; on a sphere sin depression = h/r +
/// r/(2kR) (law of cosines, to first order in h/R), so |d/dr| = h/r^2 - 1/(2kR), and h/r^2 on a plane. For
/// constant gamma.
double curved_ground_power_ratio(double slant_range_m, double height_m, double curvature);

/// Where r^2 / (2 k R h) = 1: sqrt(2 k R h). Infinite on a flat earth.
double horizon_m(double height_m, double curvature);

/// Slant range up to which going from one earth to another changes a bin's power by less than change_db (over
/// level ground, where the change grows with range). Infinite when they do not differ.
double range_of_power_change_m(double height_m, double curvature, double other_curvature, double change_db);

/// Ground distance up to which going from one earth to another moves the ground in slant range by less than
/// shift_m. Infinite when that is beyond 10,000 km.
double range_of_slant_shift_m(double height_m, double curvature, double other_curvature, double shift_m);

/// Share of a building's projected area that its walls have, seen at a depression angle: H cos e / (H cos e +
/// D sin e) for a block of height H and depth D along the view. Where walls and roofs scatter alike per
/// projected area (constant gamma) this is their share of the power.
double wall_share(double height_m, double depth_m, double depression_rad);

/// Depression above which walls have less than a share of it: tan e = H (1/share - 1) / D.
double depression_of_wall_share_rad(double height_m, double depth_m, double share);

/// Vertical error that moves the ground by shift_m in slant range, seen at a depression angle: shift / sin e.
double vertical_tolerance_m(double shift_m, double depression_rad);

/// Cell size at which a vertical error that grows as cell^order reaches another size.
double cell_of_error_m(double cell_m, double error_m, double order, double allowed_error_m);

}  // namespace obliq
