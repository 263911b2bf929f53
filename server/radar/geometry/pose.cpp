#include "server/radar/geometry/pose.h"

#include <cmath>

#include "server/radar/profile/roofs.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Height above the datum at which the plumb line of a position meets the ground; NaN where none is known.
/// The line leans by distance / earth radius, so two steps from the datum leave less than a millimetre within
/// 300 km.
double ground_height_on_plumb_line(const World& world, Geodetic at) {
  for (int step = 0; step < 3; ++step) {
    const WorldPoint p = world.frame.world_from_geodetic(at);
    const double ground_y_m = world.grid.height_at_m(p.m.x, p.m.z);
    if (std::isnan(ground_y_m)) return ground_y_m;
    at.height_m = world.frame.geodetic_from_world({glm::dvec3(p.m.x, ground_y_m, p.m.z)}).height_m;
  }
  return at.height_m;
}

}  // namespace

std::optional<Pose> place_antenna(const World& world, const PoseSettings& settings,
                                  std::vector<FieldError>& errors) {
  const std::size_t errors_before = errors.size();
  Pose pose;
  pose.settings = settings;
  Geodetic geodetic{settings.latitude_deg * kDegree_rad, settings.longitude_deg * kDegree_rad, 0};
  const double ground_height_m = ground_height_on_plumb_line(world, geodetic);
  switch (settings.height_reference) {
    case HeightReference::datum:
      geodetic.height_m = settings.height_m;
      break;
    case HeightReference::ellipsoid:
      geodetic.height_m = settings.height_m - settings.geoid_undulation_m;
      break;
    case HeightReference::ground:
      if (std::isnan(ground_height_m)) {
        errors.push_back({"antenna.height_reference", "\"ground\" where no ground is known",
                          "\"datum\" or \"ellipsoid\", or a position inside the loaded terrain"});
        return std::nullopt;
      }
      geodetic.height_m = ground_height_m + settings.height_m;
      break;
  }
  pose.antenna = world.frame.world_from_geodetic(geodetic);
  const glm::dvec3& at = pose.antenna.m;
  pose.ground_y_m = world.grid.height_at_m(at.x, at.z);
  if (at.y <= pose.ground_y_m) {
    const Geodetic foot = world.frame.geodetic_from_world({glm::dvec3(at.x, pose.ground_y_m, at.z)});
    std::string allowed =
        "an antenna above the ground, which is there at " + metres_text(foot.height_m) + " above the datum";
    if (settings.height_reference != HeightReference::ground)
      allowed += "; antenna.height_reference = \"ground\" counts the height from there";
    errors.push_back(
        {"antenna.height_m", metres_text(pose.ground_y_m - at.y) + " below the ground", allowed});
  }
  if (const auto roof_y_m = roof_above(world.buildings, at))
    errors.push_back({"antenna.height_m",
                      "inside a building, " + metres_text(*roof_y_m - at.y) + " below its roof",
                      "an antenna outside every building"});
  pose.north_rad = world.frame.north_rad(geodetic);
  // Whole turns off in degrees, where they are exact: 0 and 360 give the same bits, and so do -180 and 180.
  double bearing_deg = std::remainder(settings.bearing_deg, 360.0);
  if (bearing_deg == -180) bearing_deg = 180;
  pose.bearing_world_rad = bearing_deg * kDegree_rad + pose.north_rad;
  if (errors.size() != errors_before) return std::nullopt;
  return pose;
}

}  // namespace obliq
