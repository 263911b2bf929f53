#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/echo/scattering.h"
#include "server/truth/reference.h"
#include "server/truth/sea_truth.h"

namespace obliq {

constexpr std::int32_t kGroundStrip = -1;

/// A straight piece of surface in one vertical plane, from its nearer or lower end. d is ground distance from
/// the antenna, h height above it, metres.
struct Strip {
  double d0_m, h0_m, d1_m, h1_m;
  double plane_distance_m;  ///< D: the antenna's distance from the surface's plane in space
  std::int32_t building;    ///< kGroundStrip on ground
  std::uint8_t material;
  double raster_gamma = 1;  ///< World::raster_gamma of the ground
};

/// The largest tangent of elevation met so far. Long double: at 40 km and grazing, a double's rounding of the
/// heights would move a shadow's edge by what the tests measure.
class ExactHorizon {
 public:
  /// A part of a strip, as fractions of its length; nothing when from >= to.
  struct Lit {
    long double from = 0;
    long double to = 0;
  };

  /// The part of the strip that faces the antenna and rises above the horizon. Elevation is monotone along
  /// a straight strip, so that part always reaches to its far or upper end.
  Lit lit(long double d0, long double h0, long double d1, long double h1) const {
    if (!(h1 * d0 > h0 * d1)) return {};  // elevation falls: the strip's back
    if (!met_ || h0 >= tangent_ * d0) return {0, 1};
    if (!(h1 > tangent_ * d1)) return {};
    // h0 + s (h1 - h0) = tangent (d0 + s (d1 - d0))
    return {(tangent_ * d0 - h0) / ((h1 - h0) - tangent_ * (d1 - d0)), 1};
  }

  /// Everything met shades what comes behind, lit or not.
  void raise(long double d, long double h) {
    if (!(d > 0)) return;
    const long double tangent = h / d;
    if (met_ && tangent <= tangent_) return;
    tangent_ = tangent;
    met_ = true;
  }

 private:
  bool met_ = false;
  long double tangent_ = 0;
};

/// What a strip gives to one range bin.
struct BinShare {
  int range_bin;
  double power_w;
  double sine_w;    ///< power times the sine of its elevation
  double height_w;  ///< power times its height above the antenna
  double solid_angle_sr;
};

/// Integrates the radar equation over strips. Immutable; world and view must outlive it.
class StripIntegral {
 public:
  StripIntegral(const World& world, const std::vector<Material>& materials, const ReferenceView& view,
                double step_m);

  /// Appends one share for every range bin the strip lies in; twice when the range falls and rises again.
  /// bearing_rad: of the strip's plane; width_rad: azimuth that it stands for.
  void add(const Strip& strip, double bearing_rad, double width_rad, std::vector<BinShare>& shares) const;

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
  const std::function<double(double, double)>& two_way_gain_;
  std::vector<bool> is_sea_;  // [material]
  const WorldFrame& frame_;
  const glm::dvec3 antenna_m_;
  const SeaView sea_;
};

}  // namespace obliq
