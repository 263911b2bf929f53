#pragma once
// What moves in the wind: woods, shrubs, grass. A part of its echo stands still, the rest has a spectrum that
// falls exponentially with speed (Billingsley 2002, Low-Angle Radar Land Clutter, chapter 6).
#include "server/radar/doppler/canceller.h"
#include "server/radar/settings.h"

namespace obliq {

struct WindSpectrum {
  double moving = 0;    ///< share of the power that moves: 1 / (1 + alpha)
  double beta_s_m = 0;  ///< of exp(-beta |v|)

  /// wind_m_s: above 0.
  WindSpectrum(double wind_m_s, double frequency_ghz);
  /// Correlation of what moves, after so long.
  double correlation(double lag_s, double wavelength_m) const;
};

/// What a canceller leaves of what moves, over its mean power, behind unit noise gain: sum of a[k] cos(k
/// phase), phase of what the radar's own motion turns between two pulses.
ByLag moving_residue(const RadarSettings& settings);

}  // namespace obliq
