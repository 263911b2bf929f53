#include "server/radar/sea_state.h"

#include <algorithm>
#include <numbers>

#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {

double sea_state_of_wind(double wind_m_s) { return wind_m_s > 0 ? to_power(wind_m_s / 3.16, 1 / 0.8) : 0; }
double wind_of_sea_state(double state) { return state > 0 ? 3.16 * to_power(state, 0.8) : 0; }

SinCos wind_bearing(const RadarSettings& settings, double north_rad) {
  const double from_rad = settings.atmosphere.wind_from_deg * kDegree_rad + north_rad;
  return sincos_turns(from_rad / (2 * std::numbers::pi));
}

double sea_state(const RadarSettings& settings) {
  const double state =
      settings.sea.state_auto ? sea_state_of_wind(settings.atmosphere.wind_m_s) : settings.sea.state;
  return std::clamp(state, 0.0, kMostSeaState);
}

}  // namespace obliq
