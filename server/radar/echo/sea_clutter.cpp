#include "server/radar/echo/sea_clutter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// c1 to c5 of equation 7.
struct NrlFit {
  double c1, c2, c3, c4, c5;
};
constexpr NrlFit kHorizontal{-73.0, 20.781, 7.351, 25.65, 0.0054};
constexpr NrlFit kVertical{-50.796, 25.93, 0.7093, 21.588, 0.00211};

double sin_of(double angle_rad) { return sincos_turns(angle_rad / (2 * std::numbers::pi)).sin; }
double log10_of(double x) { return log_of_positive(x) / std::numbers::ln10; }

}  // namespace

double sea_sigma0_db(double state, double grazing_rad, double frequency_ghz, Polarisation polarisation) {
  const NrlFit& fit = polarisation == Polarisation::vertical ? kVertical : kHorizontal;
  const double degrees = std::clamp(grazing_rad / kDegree_rad, kLeastSeaGrazing_deg, kMostSeaGrazing_deg);
  const double f = std::clamp(frequency_ghz, kLeastSea_ghz, kMostSea_ghz);
  const double s = std::clamp(state, 0.0, kMostSeaState);
  return fit.c1 + fit.c2 * log10_of(sin_of(degrees * kDegree_rad)) +
         (27.5 + fit.c3 * degrees) * log10_of(f) / (1 + 0.95 * degrees) +
         fit.c4 * to_power(1 + s, 1 / (2 + 0.085 * degrees + 0.033 * s)) + fit.c5 * degrees * degrees;
}

double upwind_exponent(double grazing_rad, double frequency_ghz) {
  const double grazing =
      std::clamp(grazing_rad, kLeastSeaGrazing_deg * kDegree_rad, kMostUpwindGrazing_deg * kDegree_rad);
  const double wavelength_m = wavelength_at(std::clamp(frequency_ghz, kLeastSea_ghz, kMostSea_ghz));
  return 0.2 * (1 - 2.8 * grazing) * to_power(wavelength_m + 0.015, -0.4);
}

double bessel_i0(double z) {
  double sum = 1, term = 1;
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= z * z / (4.0 * k * k);
    sum += term;
  }
  return sum;
}

double grazing_rad(double height_m, double range_m, double radius_m) {
  // Over flat ground the radius is infinite.
  const double sine = (height_m + (height_m - range_m) * (height_m + range_m) / (2 * radius_m)) / range_m;
  return std::asin(std::clamp(sine, -1.0, 1.0));
}

}  // namespace obliq
