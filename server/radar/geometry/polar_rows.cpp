#include "server/radar/geometry/polar_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/base/asking.h"
#include "terrain/base/constants.h"

namespace obliq {
namespace {

/// Sphere of the effective earth at the median height, as the antenna sees it.
struct MedianSphere {
  double curvature = 0;    ///< 1 / (k R), 0 for flat ground
  double clearance_m = 0;  ///< antenna above it

  /// sin of the depression at which the sphere lies at slant range r: (r^2 + Rc^2 - Rm^2) / (2 r Rc) with
  /// Rc = Rm + clearance, divided through by Rc so that flat ground is the plain h / r.
  double sin_depression(double r_m) const {
    const double over_rc = curvature / (1 + curvature * clearance_m);
    return (r_m * r_m * over_rc + clearance_m * (2 - clearance_m * over_rc)) / (2 * r_m);
  }
  double horizon_m() const {
    return curvature > 0 ? std::sqrt(clearance_m * (2 / curvature + clearance_m)) : HUGE_VAL;
  }
  /// The nearer slant range of a depression: the smaller root of the quadratic behind sin_depression.
  double range_m(double sin_depression_) const {
    const double over_rc = curvature / (1 + curvature * clearance_m);
    const double c = clearance_m * (2 - clearance_m * over_rc);
    const double root = std::sqrt(std::max(0.0, sin_depression_ * sin_depression_ - over_rc * c));
    return c / (sin_depression_ + root);
  }
};

constexpr int kRun = 1024;  // rows between two times that are asked
constexpr int kARow = 30;   // its sines and arcs, in units of ask()

SinCos sincos_of(double angle_rad) { return sincos_turns(angle_rad / (2 * std::numbers::pi)); }

void add_edge(PolarRows& rows, double edge_rad) {
  if (rows.edge.size() % kRun == 0) ask(kARow * kRun);
  rows.edge_rad.push_back(edge_rad);
  rows.edge.push_back(sincos_of(edge_rad));
}

void add_even_elevations(PolarRows& rows, double to_rad, int n) {
  const double from = rows.edge_rad.back();
  for (int k = 1; k <= n; ++k) {
    add_edge(rows, from + (to_rad - from) * k / n);
    rows.ray.push_back(sincos_of(from + (to_rad - from) * (k - 0.5) / n));
  }
}

}  // namespace

PolarRows polar_rows(const Sector& sector, const SectorExtent& extent, const SectorBox& box,
                     const WorldFrame& frame, int n) {
  constexpr double kHalfPi = std::numbers::pi / 2;
  PolarRows rows;
  const double lowest = box.antenna_above_bottom_m > 0
                            ? -std::asin(std::min(1.0, box.antenna_above_bottom_m / sector.r_min_m))
                            : 0.0;
  const double highest = std::clamp(extent.highest_elevation_rad, lowest + 1e-9, kHalfPi);
  add_edge(rows, lowest);
  MedianSphere sphere;
  sphere.curvature = 1 / (frame.radius_factor() * kMeanEarthRadius_m);
  const double datum_y = frame.datum_y_m(sector.antenna_m.x, sector.antenna_m.z);
  sphere.clearance_m = sector.antenna_m.y - datum_y - extent.median_height_m;
  if (sphere.clearance_m > 0) {
    const double r_end = std::min(sector.r_max_m, sphere.horizon_m());
    const double r_start = sphere.range_m(std::sin(-lowest));
    const double ground_end = -std::asin(std::min(1.0, sphere.sin_depression(r_end)));
    if (r_start < r_end && ground_end > lowest) {
      const double above = std::max(0.0, highest - ground_end);
      const double weight = std::min(1e6, 2 * above * sector.r_max_m / (r_end - r_start));
      const int above_rows = std::min(static_cast<int>(n * weight / (1 + weight)), n / 2);
      rows.ground_rows = n - above_rows;
      for (int k = 1; k <= rows.ground_rows; ++k) {
        const double edge_m = r_start + (r_end - r_start) * k / rows.ground_rows;
        const double ray_m = r_start + (r_end - r_start) * (k - 0.5) / rows.ground_rows;
        rows.ray.push_back(sincos_of(-std::asin(std::min(1.0, sphere.sin_depression(ray_m)))));
        add_edge(rows, -std::asin(std::min(1.0, sphere.sin_depression(edge_m))));
      }
      if (above_rows > 0) add_even_elevations(rows, highest, above_rows);
      return rows;
    }
  }
  add_even_elevations(rows, highest, n);
  return rows;
}

}  // namespace obliq
