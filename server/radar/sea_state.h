#pragma once
#include "server/radar/settings.h"
#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {

constexpr double kMostSeaState = 6;
/// Of the wind's speed, with which the sea's surface drifts downwind, and its texture with it. Assumed.
constexpr double kDriftOfWind = 0.03;

/// The sea state that a steady wind raises, and the wind that raises a state: U = 3.16 s^0.8 m/s (GIT,
/// echo/sea_clutter.h), not limited.
double sea_state_of_wind(double wind_m_s);
double wind_of_sea_state(double state);
/// World bearing that the wind comes from; north_rad: the world bearing of true north.
SinCos wind_bearing(const RadarSettings& settings, double north_rad);
/// Of these settings, 0 to 6; 0: water returns what its material says, and stands still.
double sea_state(const RadarSettings& settings);

}  // namespace obliq
