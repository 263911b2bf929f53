#pragma once
// What air and rain do to echoes: attenuation on the way, and rain's own echo.
#include <vector>

#include "server/radar/settings.h"

namespace obliq {

/// Where the antenna is and how it looks. Heights above the datum, in metres.
struct AirView {
  double antenna_m = 0;
  double ground_m = 0;    ///< median of the sector
  double tilt_rad = 0;    ///< elevation of the boresight
  double across_m_s = 0;  ///< speed across the sector's middle; of use to images of synthetic aperture
};

/// gamma_R = k R^alpha, one way, in dB/km (Rec. ITU-R P.838-3), of a level path.
double rain_attenuation_db_km(double rain_mm_h, double frequency_ghz, Polarisation polarisation);

/// Of oxygen and water vapour, one way, in dB/km: Rec. ITU-R P.676-12, Annex 1, line by line, for the
/// standard atmosphere at sea level (1013.25 hPa of dry air, 288.15 K, 7.5 g/m^3).
double gas_attenuation_db_km(double frequency_ghz);

/// eta = pi^5 |K|^2 Z / lambda^4, in m^2/m^3, with Z = 200 R^1.6 mm^6/m^3 (Marshall and Palmer 1948) and
/// |K|^2 = 0.93 of water: the radar cross section of a cubic metre of rain.
double rain_reflectivity_m2_m3(double rain_mm_h, double wavelength_m);

/// Whether anything is lost on the way.
inline bool attenuates(const RadarSettings& settings) {
  return settings.atmosphere.gas || settings.atmosphere.rain_mm_h > 0;
}

/// One way, in dB/km, on the way to the ground: the part of it that is above rain_top_m loses nothing to
/// rain. To 1e-12, so that a C library's choice by processor leaves no trace.
double path_loss_db_km(const RadarSettings& settings, const AirView& air);

/// What is left of an echo's power, there and back.
double path_power_factor(double loss_db_km, double slant_range_m);

/// Mean power of rain's echo in each range bin, in watts: K eta V / r^4, attenuated as the ground behind it.
/// V is what the beam, or an azimuth bin, has of the shell between the ground's median height and rain_top_m,
/// as long as the pulse, or a range bin, weighed with the squared gain in elevation. Empty without rain.
std::vector<double> rain_echo_power_w(const RadarSettings& settings, const AirView& air);

}  // namespace obliq
