#include "server/radar/echo/corners.h"

#include <algorithm>
#include <cmath>

#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {
namespace {

/// A lobe ends where t^2 / 2 s^2 is this: exp(-6) is 0.0025.
constexpr double kDark = 6;

}  // namespace

double fresnel_reflectivity(std::complex<double> permittivity, double cos_incidence,
                            Polarisation polarisation) {
  const double c = std::clamp(cos_incidence, 0.0, 1.0);
  // root - j loss = sqrt(permittivity - sin^2), permittivity's imaginary part 0 or below.
  const double re = permittivity.real() - (1 - c * c);
  const double im = permittivity.imag();
  const double modulus = std::sqrt(re * re + im * im);
  const double root = std::sqrt(std::max(0.0, (modulus + re) / 2));
  const double loss = std::sqrt(std::max(0.0, (modulus - re) / 2));
  const bool horizontal = polarisation == Polarisation::horizontal;
  const double direct = horizontal ? c : permittivity.real() * c;
  const double direct_loss = horizontal ? 0 : -im * c;
  const double less = (direct - root) * (direct - root) + (direct_loss - loss) * (direct_loss - loss);
  const double more = (direct + root) * (direct + root) + (direct_loss + loss) * (direct_loss + loss);
  return less / more;
}

CornerTable::CornerTable(const std::vector<Material>& materials, Polarisation polarisation)
    : polarisation_(polarisation), least_slope_(1e9) {
  double most = kLeastSlope;
  rows_.reserve(materials.size());
  for (const Material& material : materials) {
    const double slope = std::max(material.rms_slope, kLeastSlope);
    rows_.push_back({1 / (2 * slope * slope),
                     1 + kDark * 2 * slope * slope,
                     {material.permittivity_re, -material.permittivity_im}});
    if (!material.used) continue;
    least_slope_ = std::min(least_slope_, slope);
    most = std::max(most, slope);
  }
  const double widest = std::sqrt(2 * kDark) * most;
  greatest_along_ = widest * kSteepest < 1 ? (widest + kSteepest) / (1 - widest * kSteepest) : HUGE_VAL;
}

double CornerTable::lobe_at(double tan2, double over_two_slope2) {
  return (1 + tan2) * (1 + tan2) * over_two_slope2 * exp_of_negative(-tan2 * over_two_slope2);
}

double CornerTable::reflectivity(std::uint8_t wall, std::uint8_t ground, double across) const {
  // k, w and q lie in one plane, and q is square to w.
  const double on_ground = std::sqrt(std::max(0.0, 1 - across * across));
  return 4 * fresnel_reflectivity(rows_[wall].permittivity, across, polarisation_) *
         fresnel_reflectivity(rows_[ground].permittivity, on_ground, polarisation_);
}

}  // namespace obliq
