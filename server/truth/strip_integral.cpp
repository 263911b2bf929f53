#include "server/truth/strip_integral.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace obliq {

namespace {

/// Nearer than this, steps shrink with range: what they integrate varies over lengths in proportion to r.
constexpr double kFullStepRange_m = 200;

/// Of one stretch in one range bin: for antennas a hair's breadth from a surface.
constexpr double kMostSteps = 1e6;

}  // namespace

/// The strip's line by its perpendicular foot and the azimuth it stands for: a point t from the foot has
/// range r^2 = p^2 + t^2.
struct StripIntegral::Line {
  double p_m;         ///< the antenna's distance from the line
  double t0_m, t1_m;  ///< of the strip's ends
  double d_per_t;     ///< ground distance gained a metre along the strip
  double foot_d_m;    ///< ground distance of the foot
  double h_per_t;     ///< height gained a metre along the strip
  double foot_h_m;    ///< height of the foot above the antenna
  double bearing_rad;
  double width_rad;

  Line(const Strip& strip, double bearing, double width) : bearing_rad(bearing), width_rad(width) {
    const double along_d = strip.d1_m - strip.d0_m;
    const double along_h = strip.h1_m - strip.h0_m;
    const double length = std::sqrt(along_d * along_d + along_h * along_h);
    const double rise = along_h / length;
    d_per_t = along_d / length;
    t0_m = strip.d0_m * d_per_t + strip.h0_m * rise;
    t1_m = t0_m + length;
    p_m = std::fabs(strip.d0_m * rise - strip.h0_m * d_per_t);
    foot_d_m = strip.d0_m - t0_m * d_per_t;
    h_per_t = rise;
    foot_h_m = strip.h0_m - t0_m * h_per_t;
  }
  double t_at_range(double r_m) const { return std::sqrt(std::max(0.0, (r_m - p_m) * (r_m + p_m))); }
};

StripIntegral::StripIntegral(const World& world, const std::vector<Material>& materials,
                             const ReferenceView& view, double step_m)
    : scattering_(materials, view.wavelength_m),
      range_constant_(view.power_w * view.gain * view.gain * view.wavelength_m * view.wavelength_m /
                      std::pow(4 * std::numbers::pi, 3)),
      step_m_(step_m),
      r_min_m_(view.r_min_m),
      r_max_m_(view.r_max_m),
      spacing_m_((view.r_max_m - view.r_min_m) / view.range_bins),
      n_range_(view.range_bins),
      range_normalisation_(view.range_normalisation),
      two_way_gain_(view.two_way_gain),
      frame_(world.frame),
      antenna_m_(view.antenna_m),
      sea_(view.sea) {
  for (const Material& material : materials)
    is_sea_.push_back(sea_.state > 0 && material.model == ScatteringModel::sea && material.gamma > 0);
}

void StripIntegral::add(const Strip& strip, double bearing_rad, double width_rad,
                        std::vector<BinShare>& shares) const {
  if (strip.d0_m == strip.d1_m && strip.h0_m == strip.h1_m) return;
  const Line line(strip, bearing_rad, width_rad);
  if (!(line.p_m > 0)) return;  // edge-on in this plane: no projected area
  // Range falls towards the foot and rises beyond it.
  if (line.t0_m < 0) add_monotone(strip, line, -1, std::max(0.0, -line.t1_m), -line.t0_m, shares);
  if (line.t1_m > 0) add_monotone(strip, line, 1, std::max(0.0, line.t0_m), line.t1_m, shares);
}

/// One side of the foot, between two distances from it.
void StripIntegral::add_monotone(const Strip& strip, const Line& line, double side, double near_m,
                                 double far_m, std::vector<BinShare>& shares) const {
  const double end_m = std::min(far_m, line.t_at_range(r_max_m_));
  double at_m = std::max(near_m, line.t_at_range(r_min_m_));
  if (!(at_m < end_m)) return;
  const double first_r_m = std::sqrt(line.p_m * line.p_m + at_m * at_m);
  int bin = std::clamp(static_cast<int>((first_r_m - r_min_m_) / spacing_m_), 0, n_range_ - 1);
  for (; bin < n_range_ && at_m < end_m; ++bin) {
    const double edge_m = bin + 1 < n_range_ ? line.t_at_range(r_min_m_ + (bin + 1) * spacing_m_) : end_m;
    const double to_m = std::min(edge_m, end_m);
    if (!(at_m < to_m)) continue;
    shares.push_back(integrate(strip, line, side * at_m, side * to_m, bin));
    at_m = to_m;
  }
}

/// Midpoint rule in equal steps of at most step_m, less where the stretch is near.
BinShare StripIntegral::integrate(const Strip& strip, const Line& line, double from_m, double to_m,
                                  int bin) const {
  const double length_m = std::fabs(to_m - from_m);
  const double nearest_m = std::sqrt(line.p_m * line.p_m + std::min(from_m * from_m, to_m * to_m));
  const double widest_m = step_m_ * std::min(1.0, nearest_m / kFullStepRange_m);
  const int steps = static_cast<int>(std::clamp(std::ceil(length_m / widest_m), 1.0, kMostSteps));
  const double step_m = length_m / steps;
  BinShare share{bin, 0, 0, 0, 0};
  for (int k = 0; k < steps; ++k) {
    const double t_m = from_m + (k + 0.5) / steps * (to_m - from_m);
    const double r2 = line.p_m * line.p_m + t_m * t_m;
    const double r_m = std::sqrt(r2);
    const double d_m = line.foot_d_m + t_m * line.d_per_t;
    const double projected_area_m2 = d_m * line.width_rad * step_m * line.p_m / r_m;
    const double height_m = line.foot_h_m + t_m * line.h_per_t;
    double sigma_m2 = scattering_.cross_section_m2(strip.material, projected_area_m2,
                                                   std::min(1.0, strip.plane_distance_m / r_m));
    if (strip.building == kGroundStrip && is_sea_[strip.material])
      sigma_m2 =
          projected_area_m2 * sea_gamma(sea_, frame_, antenna_m_,
                                        antenna_m_ + glm::dvec3(d_m * std::sin(line.bearing_rad), height_m,
                                                                d_m * std::cos(line.bearing_rad)));
    // Below 0 it takes the material's place.
    sigma_m2 =
        strip.raster_gamma < 0 ? -strip.raster_gamma * projected_area_m2 : strip.raster_gamma * sigma_m2;
    const double sine = height_m / r_m;
    double power_w = range_constant_ * (range_normalisation_ ? sigma_m2 : sigma_m2 / (r2 * r2));
    if (two_way_gain_) power_w *= two_way_gain_(sine, line.bearing_rad);
    share.power_w += power_w;
    share.sine_w += power_w * sine;
    share.height_w += power_w * sine * r_m;
    share.solid_angle_sr += projected_area_m2 / r2;
  }
  return share;
}

}  // namespace obliq
