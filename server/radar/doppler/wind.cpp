#include "server/radar/doppler/wind.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kMiles_an_hour = 2.2369362920544;  // of 1 m/s
/// Below it the laws' logarithm has no sense, and all but nothing moves.
constexpr double kLeastWind_mph = 1;

}  // namespace

WindSpectrum::WindSpectrum(double wind_m_s, double frequency_ghz) {
  const double wind_mph = std::max(kLeastWind_mph, wind_m_s * kMiles_an_hour);
  const double alpha = 489.8 * std::pow(wind_mph, -1.55) * std::pow(frequency_ghz, -1.21);
  moving = 1 / (1 + alpha);
  beta_s_m = 1 / (0.1048 * (std::log10(wind_mph) + 0.4147));
}

double WindSpectrum::correlation(double lag_s, double wavelength_m) const {
  const double x = 4 * std::numbers::pi * lag_s / (wavelength_m * beta_s_m);
  return 1 / (1 + x * x);
}

ByLag moving_residue(const RadarSettings& settings) {
  const WindSpectrum wind(settings.atmosphere.wind_m_s, settings.frequency_ghz);
  ByLag residue = canceller_autocorrelation(settings.doppler.canceller);
  for (std::size_t k = 1; k < residue.size(); ++k)
    residue[k] *= wind.correlation(static_cast<double>(k) / settings.pulse.prf_hz,
                                   wavelength_at(settings.frequency_ghz));
  return residue;
}

}  // namespace obliq
