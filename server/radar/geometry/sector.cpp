#include "server/radar/geometry/sector.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/units.h"

namespace obliq {
Sector::Sector(const RadarSettings& settings, const Pose& pose)
    : antenna_m(pose.antenna.m),
      bearing_rad(pose.bearing_world_rad),
      sin_bearing(std::sin(pose.bearing_world_rad)),
      cos_bearing(std::cos(pose.bearing_world_rad)),
      width_rad(settings.sector_deg * kPi / 180),
      r_min_m(settings.r_min_m),
      r_max_m(settings.r_max_m) {}

SectorBox::SectorBox(double above_bottom_m, double box_height_m, double r_min_m, double r_max_m,
                     double sector_rad)
    : antenna_above_bottom_m(above_bottom_m), height_m(box_height_m), kappa_m(above_bottom_m - box_height_m) {
  g_min_m = std::sqrt(std::max(0.0, r_min_m * r_min_m - above_bottom_m * above_bottom_m));
  const double rise = std::max(0.0, kappa_m);
  g_max_m = std::sqrt(std::max(0.0, r_max_m * r_max_m - rise * rise));
  near_z_m = (sector_rad <= kPi ? g_min_m : g_max_m) * std::cos(sector_rad / 2);
  depth_m = g_max_m - near_z_m;
  width_m = 2 * g_max_m * std::sin(std::min(sector_rad, kPi) / 2);
}

}  // namespace obliq
