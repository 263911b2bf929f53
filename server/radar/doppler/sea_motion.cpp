#include "server/radar/doppler/sea_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/sea_state.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kGravity_m_s2 = 9.81;
/// Surface tension over density of sea water at 15 degrees, 0.074 N/m and 1025 kg/m^3.
constexpr double kTension_m3_s2 = 7.2e-5;

}  // namespace

double bragg_speed_m_s(double wavelength_m) {
  const double k = 4 * std::numbers::pi / wavelength_m;
  return std::sqrt(kGravity_m_s2 / k + kTension_m3_s2 * k);
}

SeaMotion::SeaMotion(const RadarSettings& settings) {
  const double wind_m_s = settings.atmosphere.wind_m_s;
  if (wind_m_s > 0)
    downwind_m_s = bragg_speed_m_s(wavelength_at(settings.frequency_ghz)) + kDriftOfWind * wind_m_s;
  deviation_m_s = kSeaDeviationOfWind * wind_of_sea_state(sea_state(settings));
}

double SeaMotion::correlation(double lag_s, double wavelength_m) const {
  const double x = 4 * std::numbers::pi * deviation_m_s * lag_s / wavelength_m;
  return std::exp(-x * x / 2);
}

SeaSmear sea_smear(const SeaMotion& sea, double across_m_s) {
  constexpr double kDeviations = 3.5;
  return {std::min(kMostSeaSmear.moved_rad, sea.downwind_m_s / across_m_s),
          std::min(kMostSeaSmear.spread_rad, kDeviations * sea.deviation_m_s / across_m_s)};
}

ByLag sea_residue(const RadarSettings& settings) {
  const SeaMotion sea(settings);
  ByLag residue = canceller_autocorrelation(settings.doppler.canceller);
  for (std::size_t k = 1; k < residue.size(); ++k)
    residue[k] *= sea.correlation(static_cast<double>(k) / settings.pulse.prf_hz,
                                  wavelength_at(settings.frequency_ghz));
  return residue;
}

}  // namespace obliq
