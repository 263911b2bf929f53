#pragma once
#include <string>

namespace obliq {

/// sea: with a sea state (RadarSettings) as it says, without one as constant gamma.
enum class ScatteringModel { constant_gamma, geometric_optics, flat_plate, sea };

/// How a surface scatters (PAPER.md, eq. 12). Ratios are linear, not dB. Unused members are ignored.
struct Material {
  std::string name;
  ScatteringModel model = ScatteringModel::constant_gamma;
  double gamma = 1;  ///< constant gamma: sigma0 / cos(theta); also the floor under geometric optics, and a
                     ///< sea without state
  double reflectivity = 0.5;  ///< |R|^2 at normal incidence, 0..1
  double rms_slope = 0.1;     ///< one-axis rms slope s
  double plate_tau = 1;       ///< flat plate: tau at normal incidence
  double plate_exponent = 0;  ///< flat plate: tau(theta) = plate_tau cos(theta)^plate_exponent
  /// Relative complex permittivity, permittivity_re - j permittivity_im: of corners of wall and ground.
  double permittivity_re = 6;
  double permittivity_im = 0.6;
  bool wind = false;  ///< moves in the wind, as woods do
  bool used = true;   ///< something in the scene is made of it
};

}  // namespace obliq
