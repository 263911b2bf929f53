#include "server/radar/echo/sea_warnings.h"

#include <fmt/format.h>

#include <cmath>

#include "server/radar/echo/sea_clutter.h"
#include "server/radar/echo/sea_echo.h"
#include "terrain/base/units.h"

namespace obliq {

double range_of_grazing_m(double height_m, double grazing_rad, double radius_m) {
  // The root of r^2 + 2 r R sin(psi) = h^2 + 2 R h, over R.
  const double sine = std::sin(grazing_rad);
  const double rise = height_m * (2 + height_m / radius_m);
  return rise / (sine + std::sqrt(sine * sine + rise / radius_m));
}

std::vector<std::string> sea_warnings(const ScenePlan& plan) {
  const RadarSettings& s = plan.settings();
  std::vector<std::string> warnings;
  if (!has_sea(s, plan.scene().materials())) return warnings;
  if (s.frequency_ghz < kLeastSea_ghz || s.frequency_ghz > kMostSea_ghz)
    warnings.push_back(
        fmt::format("radar.frequency_ghz = {:.6g} with a sea state: the NRL model holds from {} to {} GHz; "
                    "the sea returns "
                    "what it does at {} GHz",
                    s.frequency_ghz, kLeastSea_ghz, kMostSea_ghz,
                    s.frequency_ghz < kLeastSea_ghz ? kLeastSea_ghz : kMostSea_ghz));
  const double raised = sea_state_of_wind(s.atmosphere.wind_m_s);
  if (s.sea.state_auto && raised > kMostSeaState)
    warnings.push_back(
        fmt::format("sea.state = \"auto\": a wind of {:.4g} m/s raises state {:.1f}; the NRL model ends at "
                    "state {}, which "
                    "the sea has",
                    s.atmosphere.wind_m_s, raised, kMostSeaState));
  const WorldFrame& frame = plan.scene().world().frame;
  const double height_m = frame.geodetic_from_world(plan.pose().antenna).height_m;
  if (!(height_m > 0)) return warnings;
  const auto range_m = [&](double degrees) {
    return range_of_grazing_m(height_m, degrees * kDegree_rad, kMeanEarthRadius_m * frame.radius_factor());
  };
  const double far_m = range_m(kLeastSeaGrazing_deg);
  if (far_m < s.r_max_m)
    warnings.push_back(fmt::format(
        "water at the datum beyond {:.1f} km is grazed at less than {} degrees, where the NRL model "
        "ends: its sigma0 there is that of {} degrees",
        far_m / 1000, kLeastSeaGrazing_deg, kLeastSeaGrazing_deg));
  const double steep_m = range_m(kMostSeaGrazing_deg);
  if (steep_m > s.r_min_m && height_m < s.r_max_m)
    warnings.push_back(fmt::format(
        "water at the datum nearer than {:.1f} km is grazed at more than {} degrees, where the NRL "
        "model ends: its sigma0 there is that of {} degrees",
        steep_m / 1000, kMostSeaGrazing_deg, kMostSeaGrazing_deg));
  const double upwind_m = range_m(kMostUpwindGrazing_deg);
  if (s.atmosphere.wind_m_s > 0 && upwind_m > s.r_min_m)
    warnings.push_back(
        fmt::format("water at the datum nearer than {:.1f} km is grazed at more than {} degrees, where GIT's "
                    "factor of the wind's direction ends: it is that of {} degrees there",
                    upwind_m / 1000, kMostUpwindGrazing_deg, kMostUpwindGrazing_deg));
  return warnings;
}

}  // namespace obliq
