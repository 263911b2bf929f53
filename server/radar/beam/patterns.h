#pragma once
#include <memory>
#include <optional>

#include "server/radar/settings.h"
#include "server/radar/taper.h"

namespace obliq {

/// One-way power gain over azimuth, 1 on the boresight. With one antenna for both ways it is the two-way
/// voltage pattern as well; mean power carries its square. "off" is a beam without width: 1 at 0, else 0.
/// Immutable.
class AzimuthPattern {
 public:
  explicit AzimuthPattern(const RadarSettings& settings);

  double power_gain(double offset_rad) const;
  /// Beyond it the gain is 0.
  double extent_rad() const { return extent_rad_; }
  /// Integral of the squared gain: the width of a box that sees as much ground. Of a Gaussian beam
  /// theta3 sqrt(pi / (8 ln 2)) (Probert-Jones 1962). 0 when off.
  double equivalent_width_rad() const;

 private:
  double shape(double offset_rad) const;
  double chosen_extent_rad() const;

  BeamPattern kind_;
  double width_rad_;
  double extent_rad_ = 0;
  std::optional<Taper> taper_;
  std::shared_ptr<const PatternCuts> file_;
};

/// One-way power gain over elevation (radians, up positive, about the antenna's own vertical), 1 at the nose;
/// everywhere when off. Cosecant squared: a Gaussian down to half a width below the nose; from there to
/// beam.cosecant_to_deg below the horizon as 1 / sin^2, so that level ground returns the same power from
/// every range (Skolnik 2008, section 9.11); below that it falls like the Gaussian. Immutable.
class ElevationGain {
 public:
  ElevationGain(const RadarSettings& settings, double tilt_rad);

  double power_gain(double elevation_rad) const;
  double tilt_rad() const { return tilt_rad_; }

 private:
  double gaussian(double offset_rad) const;

  ElevationPattern kind_;
  double tilt_rad_;
  double width_rad_;
  double cosecant_to_rad_;
  std::shared_ptr<const PatternCuts> file_;
};

}  // namespace obliq
