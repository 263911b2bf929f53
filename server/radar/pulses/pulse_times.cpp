#include "server/radar/pulses/pulse_times.h"

#include <algorithm>

#include "terrain/base/units.h"

namespace obliq {

PulseTimes::PulseTimes(const RadarSettings& settings) {
  intervals_s_ = settings.pulse.stagger;
  if (intervals_s_.empty()) intervals_s_ = {1};
  for (double& interval : intervals_s_) pattern_s_ += interval /= settings.pulse.prf_hz;
  // Sums of one pattern alone, so that a pulse's time does not depend on how it is added up.
  std::vector<double> within;
  double sum_s = 0;
  for (const double interval : intervals_s_) {
    within.push_back(sum_s);
    sum_s += interval;
  }
  const auto time_s = [&](int pulse) {
    return static_cast<double>(pulse / pattern()) * pattern_s_ +
           within[static_cast<std::size_t>(pulse % pattern())];
  };
  const double middle_s = time_s(settings.doppler.pulses - 1) / 2;
  for (int pulse = 0; pulse < settings.doppler.pulses; ++pulse) at_s_.push_back(time_s(pulse) - middle_s);
}

std::vector<int> PulseTimes::pulses_like(const std::vector<int>& ks) const {
  std::vector<int> pulses;
  for (const int k : ks)
    for (int pulse = k; pulse < n(); pulse += pattern()) pulses.push_back(pulse);
  return pulses;
}

double range_of_delay_m(double delay_s) { return kSpeedOfLight_m_s * delay_s / 2; }

std::vector<PulseTrip> pulse_trips(const PulseTimes& times, double r_min_m, double reach_m) {
  const int pattern = times.pattern();
  const auto like = std::min(pattern, times.n());
  std::vector<PulseTrip> trips{{}};
  for (int k = 0; k < like; ++k) trips.front().pulses.push_back(k);
  std::vector<double> delay_s(static_cast<std::size_t>(like), 0.0);
  for (int number = 1; number < kMostTrips; ++number) {
    for (int k = 0; k < like; ++k) {
      // The interval before the pulse that was sent `number` pulses ago.
      const int before = ((k - number) % pattern + pattern) % pattern;
      double& delay = delay_s[static_cast<std::size_t>(k)];
      delay += times.intervals_s()[static_cast<std::size_t>(before)];
      const double shift_m = range_of_delay_m(delay);
      if (r_min_m + shift_m >= reach_m) continue;
      const auto same = std::ranges::find(trips, shift_m, &PulseTrip::shift_m);
      if (same == trips.end()) {
        trips.push_back({shift_m, {k}});
      } else {
        same->pulses.push_back(k);
      }
    }
  }
  return trips;
}

}  // namespace obliq
