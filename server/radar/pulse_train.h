#pragma once
#include <complex>
#include <vector>

#include "server/radar/bins.h"

namespace obliq {

/// Along what a train of pulses is sent: through the middle of azimuth bins, a dwell's or all.
struct TrainLook {
  AzimuthRange azimuths;
  double rate_deg_s = 0;  ///< that the antenna turns at, clockwise
};

/// What a receiver gives out pulse by pulse: the samples that a processor of the user's own begins with.
struct PulseTrain {
  AzimuthRange azimuths;  ///< TrainLook's
  int n_pulses = 0;
  int n_range = 0;
  /// Intervals from pulse to pulse, one after the other, round and round.
  std::vector<double> period_ns;
  double boresight_start_deg = 0;       ///< at pulse 0, clockwise from the antenna's true north
  double boresight_rate_deg_s = 0;      ///< clockwise
  std::vector<std::complex<float>> iq;  ///< [n_pulses][n_range], as BinBlock::iq has them
};

}  // namespace obliq
