#pragma once
#include <string>
#include <vector>

#include "server/explain/radar_powers.h"
#include "server/radar/receiver/weather.h"

namespace obliq {

/// What one part of the radar does in this scene's bins, by closed forms and the bins' measured power.
struct RadarRow {
  std::string name;  ///< "noise"
  std::string text;
};

/// Beam, elevation, pulse, noise, STC, rain, gas and video.
std::vector<RadarRow> radar_rows(const RadarSettings& settings, const AirView& air,
                                 const RadarPowers& powers);

/// Signal-to-noise ratio of one pulse, in dB, at which a steady target is found with probability 0.9 at a
/// false alarm probability of 1e-6 when so many looks are integrated: Albersheim's equation (Proc. IEEE 69,
/// 1981; to 0.2 dB).
double detectable_snr_db(int looks);

}  // namespace obliq
