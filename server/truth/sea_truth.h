#pragma once
// What the sea returns, for the reference renderer: written anew from the publications, in double, without
// tables. It shares nothing with server/radar/echo/sea_clutter.h but the edges that both clamp to.
#include <glm/vec3.hpp>

#include "terrain/frames.h"

namespace obliq {

/// Plain numbers, no pipeline type.
struct SeaView {
  double state = 0;  ///< 0 to 6; 0: water is as its material
  double frequency_ghz = 10;
  bool vertical = false;           ///< polarisation
  bool has_wind = false;           ///< else it blows from nowhere
  double wind_from_world_rad = 0;  ///< world bearing that it comes from
};

/// sigma0 over the sine of grazing of water at a point, seen from another: mean, linear. Grazing is the angle
/// between the line of sight and the datum's tangent plane under the point.
double sea_gamma(const SeaView& sea, const WorldFrame& frame, const glm::dvec3& antenna_m,
                 const glm::dvec3& point_m);

}  // namespace obliq
