#pragma once

namespace obliq {

/// Where the beam's middle points in a train of pulses, off the sector's centre.
struct Boresight {
  double middle_rad = 0;  ///< at time 0
  double rate_rad_s = 0;
  double at_rad(double t_s) const { return middle_rad + rate_rad_s * t_s; }
};

}  // namespace obliq
