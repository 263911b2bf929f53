#pragma once
#include <vector>

#include "server/radar/echo/scattering.h"
#include "server/truth/reference.h"
#include "server/truth/strip.h"

namespace obliq {

/// What a strip gives to one range bin.
struct BinShare {
  int range_bin;
  double power_w;
  double solid_angle_sr;
};

/// Integrates the radar equation over strips. Immutable.
class StripIntegral {
 public:
  StripIntegral(const std::vector<Material>& materials, const ReferenceView& view, double step_m);

  /// Appends one share for every range bin the strip lies in; twice when the range falls and rises again.
  /// width_rad: azimuth that the strip's plane stands for.
  void add(const Strip& strip, double width_rad, std::vector<BinShare>& shares) const;

 private:
  struct Line;
  void add_monotone(const Strip& strip, const Line& line, double side, double near_m, double far_m,
                    std::vector<BinShare>& shares) const;
  BinShare integrate(const Strip& strip, const Line& line, double from_m, double to_m, int bin) const;

  ScatteringTable scattering_;
  double range_constant_;  // K
  double step_m_;
  double r_min_m_, r_max_m_, spacing_m_;
  int n_range_;
  bool range_normalisation_;
};

}  // namespace obliq
