#include "server/truth/sea_truth.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Over which the datum's slope is taken: its rounding and its curvature are both below 1e-9.
constexpr double kSlopeStep_m = 100;

/// NRL/MR/5310-12-9346, equation 7.
double nrl_db(const SeaView& sea, double degrees) {
  const double f = std::clamp(sea.frequency_ghz, 0.5, 35.0);
  const double s = std::min(sea.state, 6.0);
  const double state_root = std::pow(1 + s, 1 / (2 + 0.085 * degrees + 0.033 * s));
  const double sine_db = std::log10(std::sin(degrees * kDegree_rad));
  const double over = std::log10(f) / (1 + 0.95 * degrees);
  if (sea.vertical)
    return -50.796 + 25.93 * sine_db + (27.5 + 0.7093 * degrees) * over + 21.588 * state_root +
           0.00211 * degrees * degrees;
  return -73.0 + 20.781 * sine_db + (27.5 + 7.351 * degrees) * over + 25.65 * state_root +
         0.0054 * degrees * degrees;
}

/// GIT's factor of the wind's direction over its mean over all bearings, by 16 of them: the sum over a period
/// is exact but for 1e-15.
double upwind(const SeaView& sea, double grazing_rad, double against_rad) {
  const double wavelength_m = 0.299792458 / std::clamp(sea.frequency_ghz, 0.5, 35.0);
  const double grazing = std::min(grazing_rad, 10 * kDegree_rad);
  const auto factor = [&](double phi) {
    return std::exp(0.2 * std::cos(phi) * (1 - 2.8 * grazing) * std::pow(wavelength_m + 0.015, -0.4));
  };
  double mean = 0;
  constexpr int kBearings = 16;
  for (int k = 0; k < kBearings; ++k) mean += factor(2 * std::numbers::pi * k / kBearings) / kBearings;
  return factor(against_rad) / mean;
}

}  // namespace

double sea_gamma(const SeaView& sea, const WorldFrame& frame, const glm::dvec3& antenna_m,
                 const glm::dvec3& point_m) {
  const auto slope = [&](double dx, double dz) {
    return (frame.datum_y_m(point_m.x + dx, point_m.z + dz) -
            frame.datum_y_m(point_m.x - dx, point_m.z - dz)) /
           (2 * kSlopeStep_m);
  };
  const glm::dvec3 up = glm::normalize(glm::dvec3(-slope(kSlopeStep_m, 0), 1, -slope(0, kSlopeStep_m)));
  const glm::dvec3 sight = antenna_m - point_m;
  const double grazing = std::asin(std::clamp(glm::dot(up, sight) / glm::length(sight), -1.0, 1.0));
  const double within = std::clamp(grazing, 0.1 * kDegree_rad, 60 * kDegree_rad);
  double gamma = std::pow(10, nrl_db(sea, within / kDegree_rad) / 10) / std::sin(within);
  if (sea.has_wind && (sight.x != 0 || sight.z != 0))
    gamma *= upwind(sea, within, std::atan2(-sight.x, -sight.z) - sea.wind_from_world_rad);
  return gamma;
}

}  // namespace obliq
