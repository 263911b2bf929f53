#pragma once
// When the pulses of a train are sent, and which echoes come back in whose time.
#include <vector>

#include "server/radar/settings.h"

namespace obliq {

/// Of doppler.pulses pulses, pulse.prf_hz and pulse.stagger. Time 0 is midway between the first and the last.
class PulseTimes {
 public:
  explicit PulseTimes(const RadarSettings& settings);

  int n() const { return static_cast<int>(at_s_.size()); }
  double at_s(int pulse) const { return at_s_[static_cast<std::size_t>(pulse)]; }
  double length_s() const { return at_s_.back() - at_s_.front(); }
  /// From a pulse to the next, round and round: interval k follows pulses k, k + pattern(), ...
  const std::vector<double>& intervals_s() const { return intervals_s_; }
  int pattern() const { return static_cast<int>(intervals_s_.size()); }
  double pattern_s() const { return pattern_s_; }
  /// Pulses k, k + pattern(), ... of the train.
  int n_like(int k) const { return (n() - k + pattern() - 1) / pattern(); }
  /// Those of each k, one k after the other (PulseTrip::pulses).
  std::vector<int> pulses_like(const std::vector<int>& ks) const;

 private:
  std::vector<double> intervals_s_;
  std::vector<double> at_s_;
  double pattern_s_ = 0;
};

/// Echoes that come back a number of pulses after their own: those from a range r + shift_m show at r.
struct PulseTrip {
  double shift_m = 0;
  std::vector<int> pulses;  ///< k of all pulses k, k + pattern(), ... in whose time they come back so
};

/// The most trips that are looked at: later ones are 36 dB weaker than the first and more.
constexpr int kMostTrips = 4;

/// The first trip, and those from no farther than reach_m: nothing is seen beyond it. r_min_m: where gates
/// begin.
std::vector<PulseTrip> pulse_trips(const PulseTimes& times, double r_min_m, double reach_m);

/// Range whose echo comes back after that time.
double range_of_delay_m(double delay_s);

}  // namespace obliq
