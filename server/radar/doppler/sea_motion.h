#pragma once
// What the sea's own motion does to the Doppler of its echoes: a Gaussian spectrum about a mean.
//
// Mean: the scatterers are waves of half the radar's wavelength along the surface (Bragg), which run downwind
// at their phase speed, c^2 = g / k + (T / rho) k with k = 4 pi / lambda, upon water that the wind drags
// along. D. B. Trizna, "A model for Doppler peak spectral shift for low grazing angle sea scatter", IEEE J.
// Oceanic Eng. 10(4), 1985, has both: it agrees with vertical polarisation; horizontal polarisation moves
// faster, and so do high waves, which are left out. Across the wind the mean is 0: it goes with the cosine
// between. Deviation: 0.101 of the wind's speed (F. E. Nathanson, Radar Design Principles, 1969: half power
// width 0.24 of it), of the wind that raises the state.
#include <vector>

#include "server/radar/doppler/canceller.h"
#include "server/radar/doppler/ground_doppler.h"
#include "server/radar/settings.h"

namespace obliq {

constexpr double kSeaDeviationOfWind = 0.101;

/// Phase speed of waves that are half a radar's wavelength long.
double bragg_speed_m_s(double wavelength_m);

struct SeaMotion {
  double downwind_m_s = 0;   ///< the mean; 0 without wind, which has a direction
  double deviation_m_s = 0;  ///< standard deviation

  explicit SeaMotion(const RadarSettings& settings);
  double deviation_hz(double wavelength_m) const { return 2 * deviation_m_s / wavelength_m; }
  /// Size of the correlation after so long; the mean turns its phase.
  double correlation(double lag_s, double wavelength_m) const;
};

/// How far beside itself an image of synthetic aperture shows the sea, in azimuth.
struct SeaSmear {
  double moved_rad = 0;   ///< by its mean, where that runs along the line of sight
  double spread_rad = 0;  ///< by 3.5 deviations
  double reach_rad() const { return moved_rad + spread_rad; }
};
/// Farther it is not shown, however slow the antenna: its power stays within.
constexpr SeaSmear kMostSeaSmear{0.01, 0.03};
/// across_m_s: of the antenna across the line of sight.
SeaSmear sea_smear(const SeaMotion& sea, double across_m_s);

/// Water that moves as the sea does.
struct MovingSea {
  std::vector<int> materials = {};  ///< sorted; empty: none
  SectorVelocity velocity = {};     ///< of the antenna over it
  double beam_rad = 0;              ///< that looks at it, half power
  SeaSmear smear = {};              ///< of an image of synthetic aperture
};

/// What a canceller leaves of the sea over its mean power, as moving_residue: sum of a[k] cos(k phase), phase
/// of what the sea's mean and the radar's own motion turn between two pulses.
ByLag sea_residue(const RadarSettings& settings);

}  // namespace obliq
