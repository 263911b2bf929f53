#pragma once
// What the tests of the reference renderer share: a view, and the radar equation over one straight line in a
// vertical plane in closed form.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/truth/reference.h"
#include "tests/support/made_worlds.h"

namespace obliq::test {

constexpr double kPi = std::numbers::pi;

/// 3 cm wavelength, 1 W, no gain.
inline ReferenceView view_from(const glm::dvec3& antenna_m, double bearing_deg, double sector_deg,
                               int azimuth_bins, double r_min_m, double r_max_m, int range_bins) {
  ReferenceView view;
  view.antenna_m = antenna_m;
  view.bearing_rad = bearing_deg * kDegree_rad;
  view.sector_rad = sector_deg * kDegree_rad;
  view.azimuth_bins = azimuth_bins;
  view.r_min_m = r_min_m;
  view.r_max_m = r_max_m;
  view.range_bins = range_bins;
  view.wavelength_m = 0.03;
  return view;
}

inline double range_constant(const ReferenceView& view) {
  return view.power_w * std::pow(view.gain * view.wavelength_m, 2) / std::pow(4 * kPi, 3);
}

inline double range_edge_m(const ReferenceView& view, int bin) {
  return view.r_min_m + bin * (view.r_max_m - view.r_min_m) / view.range_bins;
}

inline ReferenceBins integrate_all(const World& world, const std::vector<Material>& materials,
                                   const ReferenceView& view, const ReferenceSampling& sampling = {}) {
  return integrate_reference(world, materials, view, sampling, 0, view.azimuth_bins);
}

inline std::size_t bin_index(const ReferenceBins& bins, int azimuth, int range) {
  return static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(bins.n_range) +
         static_cast<std::size_t>(range);
}

/// Smooth hills of 120 m.
inline double hills_m(double x_m, double z_m) {
  return 60 * std::sin(x_m / 700 + 1) * std::cos(z_m / 700) + 60 * std::sin((x_m + 2 * z_m) / 1100);
}

/// Houses of tens of metres at any angle, in a fan around north: the nth at nearest_m + n spacing_m.
inline void add_houses(World& world, int houses, double nearest_m, double spacing_m, double fan_rad) {
  for (int n = 0; n < houses; ++n) {
    const double golden = n * 0.618 - std::floor(n * 0.618);
    const double range = nearest_m + n * spacing_m, bearing = (golden - 0.5) * fan_rad;
    const double turn = 0.9 * n, width = 40 + 3 * (n % 7), depth = 30 + 5 * (n % 4);
    const glm::dvec2 at(range * std::sin(bearing), range * std::cos(bearing));
    const glm::dvec2 u(width * std::cos(turn), width * std::sin(turn));
    const glm::dvec2 v(-depth * std::sin(turn), depth * std::cos(turn));
    add_prism(world, {at, at + u, at + u + v, at + v}, 12 + n % 5 * 6);
  }
}

/// A straight line in the vertical plane of one azimuth, from (d0, h0) to (d1, h1): ground distance and
/// height above the antenna.
struct ProfileLine {
  double d0_m, h0_m, d1_m, h1_m;
};

/// Integral of A_proj / r^4 per radian of azimuth over the part of a line with slant range in [r1, r2], for
/// lines whose range rises from end to end. With t the distance from the foot of the antenna's perpendicular,
/// of length p, and d = d_f + t cos(a): A_proj = d p / r dt, r^2 = p^2 + t^2, and
///   int t / r^5 dt = -1 / (3 r^3),   int 1 / r^5 dt = t / (3 p^2 r^3) + 2 t / (3 p^4 r).
inline double line_integral(const ProfileLine& line, double r1_m, double r2_m) {
  const double length = std::hypot(line.d1_m - line.d0_m, line.h1_m - line.h0_m);
  const double cos_a = (line.d1_m - line.d0_m) / length;
  const double sin_a = (line.h1_m - line.h0_m) / length;
  const double t0 = line.d0_m * cos_a + line.h0_m * sin_a;
  const double p = std::abs(line.d0_m * sin_a - line.h0_m * cos_a);
  const double foot_d = line.d0_m - t0 * cos_a;
  const auto at_range = [&](double r) { return std::sqrt(std::max(0.0, r * r - p * p)); };
  const double from = std::max(t0, at_range(r1_m));
  const double to = std::min(t0 + length, at_range(r2_m));
  if (!(from < to)) return 0;
  const auto primitive = [&](double t) {
    const double r = std::hypot(p, t);
    return p * (-cos_a / (3 * r * r * r) +
                foot_d * (t / (3 * p * p * r * r * r) + 2 * t / (3 * p * p * p * p * r)));
  };
  return primitive(to) - primitive(from);
}

}  // namespace obliq::test
