#pragma once
#include <chrono>
#include <span>
#include <vector>

#include "server/flight/window.h"

namespace obliq {

/// How fast radars move over the ground, from where they are told to be, measured over at least half a
/// second. For one thread.
class Speedometer {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void note(std::span<const RadarPlace> radars, Time now);
  /// Where they will be so much later if they go on as they do.
  std::vector<RadarPlace> ahead(std::span<const RadarPlace> radars, double later_s) const;

 private:
  std::vector<RadarPlace> from_;
  std::vector<RadarPlace> to_;
  Time since_;
  double elapsed_s_ = 0;  ///< between the two
};

}  // namespace obliq
