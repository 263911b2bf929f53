#pragma once
// Models of what the sea returns, without a scene.
//
// NRL: V. Gregers-Hansen and R. Mittal, "An improved empirical model for radar sea clutter reflectivity",
// NRL/MR/5310-12-9346 (2012), equation 7: a fit to Nathanson's tables, for 0.5 to 35 GHz, grazing of 0.1 to
// 60 degrees, sea states 0 to 6. Published models differ from each other by 3 to 15 dB.
// GIT: M. M. Horst, F. B. Dyer, M. T. Tuley, "Radar sea clutter model", IEE Conf. Publ. 169 (1978): of it
// only what the wind's direction does, up to 10 degrees of grazing.
#include "server/radar/sea_state.h"

namespace obliq {

/// The model's edges: what is beyond takes the value there.
constexpr double kLeastSea_ghz = 0.5;
constexpr double kMostSea_ghz = 35;
constexpr double kLeastSeaGrazing_deg = 0.1;
constexpr double kMostSeaGrazing_deg = 60;
constexpr double kMostUpwindGrazing_deg = 10;

/// Mean sigma0 of the NRL model, in dB.
double sea_sigma0_db(double state, double grazing_rad, double frequency_ghz, Polarisation polarisation);

/// z of GIT's A_u = exp(z cos(phi)), phi from the bearing that the wind comes from to that of the look; its
/// mean over phi is I0(z), the modified Bessel function.
double upwind_exponent(double grazing_rad, double frequency_ghz);
double bessel_i0(double z);

/// Grazing angle at level water on a sphere, from so high above it at that slant range: sin(psi) =
/// (h^2 + 2 R h - r^2) / (2 r R). Negative beyond the horizon.
double grazing_rad(double height_m, double range_m, double radius_m);

}  // namespace obliq
