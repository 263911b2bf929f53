#include "server/radar/sea_state.h"

#include <algorithm>

#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {
namespace {

/// x^power, x > 0.
double power_of(double x, double power) { return ratio_of_db(power * db_of_ratio(x)); }

}  // namespace

double sea_state_of_wind(double wind_m_s) { return wind_m_s > 0 ? power_of(wind_m_s / 3.16, 1 / 0.8) : 0; }
double wind_of_sea_state(double state) { return state > 0 ? 3.16 * power_of(state, 0.8) : 0; }

double sea_state(const RadarSettings& settings) {
  const double state =
      settings.sea.state_auto ? sea_state_of_wind(settings.atmosphere.wind_m_s) : settings.sea.state;
  return std::clamp(state, 0.0, kMostSeaState);
}

}  // namespace obliq
