#pragma once
#include <chrono>
#include <span>
#include <vector>

#include "server/flight/window.h"

namespace obliq {

/// How fast radars move over the ground, from where they are told to be, measured over at least half a
/// second. Radars of which nothing is heard for kStandsAfter stand still: the last pose may have been a jump,
/// or the last of a flight. For one thread.
class Speedometer {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kStandsAfter{2};

  void note(std::span<const RadarPlace> radars, Time now);
  /// Where these radars will be `later_s` from now if they keep their speeds.
  std::vector<RadarPlace> ahead(std::span<const RadarPlace> radars, double later_s, Time now) const;

 private:
  std::vector<RadarPlace> from_;
  std::vector<RadarPlace> to_;
  Time since_;
  Time heard_;
  double elapsed_s_ = 0;  ///< between the two
};

}  // namespace obliq
