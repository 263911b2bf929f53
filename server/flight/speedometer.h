#pragma once
#include <chrono>
#include <span>
#include <vector>

#include "server/flight/window.h"

namespace obliq {

/// How fast the fastest of the radars moves over the ground, from where they are told to be, measured over at
/// least half a second. For one thread.
class Speedometer {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void note(std::span<const RadarPlace> radars, Time now);
  double speed_m_s() const { return speed_m_s_; }

 private:
  std::vector<RadarPlace> from_;
  Time since_;
  double speed_m_s_ = 0;
};

}  // namespace obliq
