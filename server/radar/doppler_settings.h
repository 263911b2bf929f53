#pragma once

namespace obliq {

/// What the radar makes of its pulses: the mean echo of each bin, a moving target indicator, a map sharpened
/// by Doppler (Doppler beam sharpening), an image of synthetic aperture (README.md of doppler/); or nothing
/// yet: the pulses themselves.
enum class RadarMode { map, mti, dbs, sar, pulses };
/// Weights of the pulses of a Doppler filter.
enum class DopplerWindow { none, hamming, hann, taylor, blackman_harris };

/// [doppler].
struct DopplerSettings {
  int pulses = 16;  ///< that a map sharpened by Doppler adds up; of a train
  DopplerWindow window = DopplerWindow::hamming;
  int canceller = 2;          ///< delays of the moving target indicator
  bool clutter_lock = false;  ///< its notch follows the ground in the beam's middle
  double resolution_m = 3;    ///< of an image of synthetic aperture, across range
  /// Sharp rows that a beamwidth has beyond its Doppler cells. No key: fewer are wrong (doppler_rows_test).
  double rows_beside_cells = 3;
};

}  // namespace obliq
