#pragma once
#include <vector>

#include "server/radar/beam/patterns.h"

namespace obliq {

/// Cosines of elevation in steps of 2 % from 1 down to 0.05: ground that a row of sharp bins sees in a tile
/// of ranges has the azimuth weights of the nearest.
namespace cosine_steps {
constexpr double kRatio = 1.02;
constexpr int kCount = 152;
double cosine(int step);
/// The nearest one by its logarithm.
int nearest(double sin_elevation);
}  // namespace cosine_steps

/// A beam over the azimuths of ground at one elevation e. Ground at an azimuth off the boresight stands at
/// the antenna's own angle asin(cos(e) sin(azimuth)), so that a narrow beam is 1 / cos(e) as wide there, and
/// all azimuths of one side are in the beam straight below the antenna. Of an antenna that turns while it
/// looks, the mean over the turn (Simpson's rule). Immutable.
class BeamOnGround {
 public:
  /// spacing_rad: at least so finely sums stand for integrals.
  BeamOnGround(const AzimuthPattern& pattern, double turn_rad, double spacing_rad);

  /// One-way power gain.
  double gain(double azimuth_rad, double cos_elevation) const;
  /// Beyond it the gain is 0; at most pi.
  double extent_rad(double cos_elevation) const;
  /// Integral of the squared gain over all azimuths, by the trapezoidal rule.
  double width_rad(double cos_elevation) const;

 private:
  double still(double azimuth_rad, double cos_elevation) const;

  const AzimuthPattern& pattern_;
  double turn_rad_;
  double spacing_rad_;
};

/// BeamOnGround::width_rad, looked up: within 1e-4 of itself down to the least cosine, and that of the least
/// below. Immutable.
class BeamWidths {
 public:
  BeamWidths(const BeamOnGround& beam, double least_cosine);
  double at(double cos_elevation) const;

 private:
  std::vector<double> log_rad_;  // by cosine steps, on beyond the last
};

}  // namespace obliq
