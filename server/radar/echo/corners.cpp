#include "server/radar/echo/corners.h"

#include <algorithm>
#include <cmath>

#include "server/radar/simd/exact_math.h"

namespace obliq {
namespace {

/// A lobe ends where t^2 / 2 s^2 is this: exp(-14) is below 1e-6.
constexpr double kDark = 14;

}  // namespace

double fresnel_reflectivity(std::complex<double> permittivity, double cos_incidence,
                            Polarisation polarisation) {
  const double c = std::clamp(cos_incidence, 0.0, 1.0);
  const std::complex<double> root = std::sqrt(permittivity - (1 - c * c));
  const std::complex<double> direct =
      polarisation == Polarisation::horizontal ? std::complex<double>(c) : permittivity * c;
  return std::norm((direct - root) / (direct + root));
}

CornerTable::CornerTable(const std::vector<Material>& materials, Polarisation polarisation)
    : polarisation_(polarisation), least_slope_(1e9), most_slope_(kLeastSlope) {
  rows_.reserve(materials.size());
  for (const Material& material : materials) {
    const double slope = std::max(material.rms_slope, kLeastSlope);
    rows_.push_back({1 / (2 * slope * slope), {material.permittivity_re, -material.permittivity_im}});
    if (!material.used) continue;
    least_slope_ = std::min(least_slope_, slope);
    most_slope_ = std::max(most_slope_, slope);
  }
}

double CornerTable::lobe(std::uint8_t ground, const CornerSight& sight, const FootSlope& slope) const {
  // q . n, times n's length.
  const double along_normal = sight.up - slope.along * sight.along - slope.across * sight.lean;
  if (!(along_normal > 0)) return 0;
  const double length2 = 1 + slope.across * slope.across + slope.along * slope.along;
  const double q2 = sight.along * sight.along + sight.up * sight.up + sight.lean * sight.lean;
  const double tan2 = std::max(0.0, q2 * length2 / (along_normal * along_normal) - 1);
  const double over_two_slope2 = rows_[ground].over_two_slope2;
  const double fall = tan2 * over_two_slope2;
  if (!(fall < kDark)) return 0;
  return (1 + tan2) * (1 + tan2) * over_two_slope2 * exp_of_negative(-fall);
}

double CornerTable::reflectivity(std::uint8_t wall, std::uint8_t ground, double across) const {
  // k, w and q lie in one plane, and q is square to w.
  const double on_ground = std::sqrt(std::max(0.0, 1 - across * across));
  return 4 * fresnel_reflectivity(rows_[wall].permittivity, across, polarisation_) *
         fresnel_reflectivity(rows_[ground].permittivity, on_ground, polarisation_);
}

bool CornerTable::may_shine(double along_over_up) const {
  const double level = std::abs(along_over_up);
  if (level < kSteepest) return true;
  // tan of the angle that is left when the ground leans towards q as far as it may.
  const double left = (level - kSteepest) / (1 + level * kSteepest);
  return left * left / (2 * most_slope_ * most_slope_) < kDark;
}

}  // namespace obliq
