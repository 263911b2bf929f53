#include "server/radar/targets/target_place.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "server/radar/profile/plumb_line.h"
#include "server/radar/simd/exact_math.h"
#include "terrain/base/units.h"
#include "terrain/tangent_step.h"

namespace obliq {
namespace {

constexpr double kFarthest_m = 10e6;

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  std::int64_t difference = 0;
  if (!__builtin_sub_overflow(to_ns, from_ns, &difference)) return static_cast<double>(difference) * 1e-9;
  return (static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9;
}

}  // namespace

std::optional<TargetPlace> place_target(const World& world, const Target& target, std::int64_t sim_time_ns) {
  const double t = seconds_between(target.sim_time_ns, sim_time_ns);
  const glm::dvec3 step_m = target.velocity_m_s * t + target.acceleration_m_s2 * (t * t / 2);
  if (!(glm::length(step_m) < kFarthest_m)) return std::nullopt;
  const bool over_ground = target.height_reference == HeightReference::ground;
  const double from_height_m =
      over_ground
          ? 0
          : target.height_m -
                (target.height_reference == HeightReference::ellipsoid ? target.geoid_undulation_m : 0);
  const glm::dvec3 level_step_m(step_m.x, over_ground ? 0 : step_m.y, step_m.z);
  Geodetic at{target.latitude_deg * kDegree_rad, target.longitude_deg * kDegree_rad, from_height_m};
  if (level_step_m != glm::dvec3(0.0)) at = moved(at, level_step_m);

  const PlumbLine line(world.frame, at.latitude_rad, at.longitude_rad);
  double height_m = at.height_m;
  if (over_ground) {
    const auto ground = line.meet(world.grid);
    height_m = (ground ? ground->height_m : 0) + target.height_m + step_m.y;
  }
  TargetPlace place{line.at_height(height_m), 0};
  const glm::dvec3 course = target.velocity_m_s + target.acceleration_m_s2 * t;
  const double heading_rad =
      target.heading_deg ? *target.heading_deg * kDegree_rad : bearing_of(course.x, course.z);
  place.heading_rad =
      std::remainder(heading_rad + target.heading_rate_deg_s * kDegree_rad * t, 360 * kDegree_rad) +
      line.north_rad();
  const double sum = place.foot_m.x + place.foot_m.y + place.foot_m.z + place.heading_rad;
  if (!std::isfinite(sum)) return std::nullopt;
  return place;
}

}  // namespace obliq
