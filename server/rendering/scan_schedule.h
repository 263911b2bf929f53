#pragma once
// Where the beam of a scanning antenna is at any time. Pure functions of the settings and of when it began.
#include <chrono>
#include <cstdint>

#include "server/radar/render.h"
#include "server/radar/settings.h"

namespace obliq::rendering {

/// One dwell of the beam: the azimuth bins that it passes with one pose.
struct Dwell {
  std::uint64_t pass = 0;  ///< counted from the beginning
  int number = 0;          ///< within the pass, in the order of the beam

  auto operator<=>(const Dwell&) const = default;
};

/// The beam begins at the left edge of the sector and turns at a constant rate: in circular mode always
/// clockwise, in sector mode to and fro, turning about at each edge without delay. A pass is one sweep over
/// all azimuth bins.
class ScanSchedule {
 public:
  using Time = std::chrono::steady_clock::time_point;

  ScanSchedule(const RadarSettings& settings, Time begin);

  /// The beam has stood still for so long.
  void delay(Time::duration pause) { begin_ += pause; }

  int dwells() const { return dwells_; }
  bool is_clockwise(std::uint64_t pass) const { return !to_and_fro_ || pass % 2 == 0; }
  AzimuthRange azimuths(const Dwell& dwell) const;

  Time pass_begin(std::uint64_t pass) const;
  Time middle(const Dwell& dwell) const { return at(dwell, 0.5); }
  Time end(const Dwell& dwell) const { return at(dwell, 1); }
  Dwell after(const Dwell& dwell) const;

  /// The dwell that the beam is in. Before the beginning: the first.
  Dwell at(Time now) const;

  /// Which dwell to render next when `next` is the one in order: that one, as long as the beam has not left
  /// it by more than the lag allowed; else the dwell that the beam is in now, and those between are missed.
  Dwell next(const Dwell& in_order, Time now) const;

  /// A quarter of a pass, at most a quarter of a second.
  double lag_s() const { return lag_s_; }

 private:
  Time at(const Dwell& dwell, double share) const;

  Time begin_;
  bool to_and_fro_ = false;
  int azimuth_bins_ = 0;
  int dwell_bins_ = 0;
  int dwells_ = 0;
  double bin_s_ = 0;
  double pass_s_ = 0;
  double lag_s_ = 0;
};

}  // namespace obliq::rendering
